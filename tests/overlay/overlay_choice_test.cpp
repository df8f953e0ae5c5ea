#include "overlay/overlay_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"

namespace cradle {
namespace {

Scene twoBodies() {
  Scene scene;
  scene.bodies.resize(2);
  scene.bodies[0].name = "ground";
  scene.bodies[0].motion = Motion::fixed;
  scene.bodies[1].name = "ball";
  return scene;
}

TEST(OverlayChoice, WordsComeInAnyOrder) {
  const OverlayChoice choice = parseOverlays("trails,plot=height:ball,time");
  EXPECT_TRUE(choice.trails && choice.time);
  EXPECT_FALSE(choice.contacts || choice.velocities);
  EXPECT_EQ(choice.plot, PlotKind::height);
  EXPECT_EQ(plottedBody(choice, twoBodies()), 1);
  EXPECT_EQ(parseOverlays("plot=energyError").plot, PlotKind::energyError);
}

TEST(OverlayChoice, AnythingElseIsRefusedWithWhatIsAllowed) {
  const auto refusal = [](const std::string& text) -> std::string {
    try {
      const OverlayChoice choice = parseOverlays(text);
      if (choice.plot == PlotKind::height) plottedBody(choice, twoBodies());
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      return error.what();
    }
    return "";
  };
  using testing::HasSubstr;
  for (const char* text : {"", "tme", "time,", "time trails", "plot", "plot=heat", "Time"})
    EXPECT_THAT(refusal(text), HasSubstr("allowed are time, contacts")) << text;
  EXPECT_THAT(refusal("plot=height:bal"),
              HasSubstr("no body of that name; allowed are \"ball\"; did you mean \"ball\"?"));
  EXPECT_THAT(refusal("plot=height:ground"), HasSubstr("static; allowed are \"ball\""));
  EXPECT_THAT(refusal("plot=energy,plot=height:ball"), HasSubstr("one plot"));
}

}  // namespace
}  // namespace cradle
