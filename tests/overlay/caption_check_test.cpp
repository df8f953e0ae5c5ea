#include "overlay/caption_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"

namespace cradle {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string refusalOf(const Scene& scene) {
  try {
    requireReadableWords(scene);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::scene);
    return error.what();
  }
  return "";
}

Scene sceneWith(const std::vector<Caption>& captions) {
  Scene scene;
  scene.captions = captions;
  return scene;
}

TEST(CaptionCheck, CharactersThatTheFontLacksAreNamedWithTheirPlace) {
  Scene scene = sceneWith({{"Größe ≤ 3 µm → ½, Ω и Жук", 0, 1, kWorld, "first"}, {"a 漢字", 0, 1, kWorld, "second"}});
  scene.titleCard = {"Go \U0001F680", "fine\nand 日", 3, "title", "subtitle"};
  const std::string refusal = refusalOf(scene);
  EXPECT_THAT(refusal, Not(HasSubstr("first")));
  EXPECT_THAT(refusal, HasSubstr("second: found the character \"漢\" (U+6F22), which the font of pictures has not"));
  EXPECT_THAT(refusal, HasSubstr("title: found the character \"\U0001F680\" (U+1F680)"));
  EXPECT_THAT(refusal, HasSubstr("subtitle: found the character \"日\" (U+65E5)"));
  EXPECT_EQ(std::count(refusal.begin(), refusal.end(), '\n'), 2);
}

// Sixty captions of a second each, one after the other, are in order; sixty at once are not. One takes 1.73 em and half
// of one as a gap, 45 pixels of 670: the sixteenth is told.
TEST(CaptionCheck, CaptionsAtOnceMustFit) {
  std::vector<Caption> captions;
  for (int i = 0; i < 60; ++i) captions.push_back({"Words", i * 1.0, i + 1.0, kWorld, "caption " + std::to_string(i)});
  EXPECT_EQ(refusalOf(sceneWith(captions)), "");
  for (Caption& caption : captions) caption.to = 1000;
  EXPECT_THAT(refusalOf(sceneWith(captions)), HasSubstr("caption 15: 16 captions are shown at 15 s, with"));
  std::swap(captions[0], captions[59]);
  EXPECT_THAT(refusalOf(sceneWith(captions)), HasSubstr("caption 15: 16 captions"));
}

TEST(CaptionCheck, IsOfTheSizeOfThePictures) {
  Scene scene = sceneWith({{std::string(250, 'w'), 0, 1, kWorld, "place"}});
  scene.titleCard = {std::string(250, 'w'), "", 3, "title", ""};
  EXPECT_EQ(refusalOf(scene), "");
  EXPECT_NO_THROW(requireRoomForWords(scene, 360, 640));
  scene.output.width = 40, scene.output.height = 720;
  EXPECT_THAT(refusalOf(scene), HasSubstr("place: this caption is shown at 0 s, with"));
  EXPECT_THAT(refusalOf(scene), HasSubstr("title: title and subtitle take"));
  EXPECT_THAT(refusalOf(scene), HasSubstr("in a picture of 40x720"));
}

}  // namespace
}  // namespace cradle
