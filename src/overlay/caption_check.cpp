#include "overlay/caption_check.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/printable.h"
#include "image/font.h"
#include "overlay/caption_layout.h"

namespace cradle {
namespace {

constexpr std::size_t kMaxFaults = 50;  // as of other faults of a scene

/// "é" in UTF-8.
std::string inUtf8(char32_t character) {
  const auto byte = [](char32_t bits) { return static_cast<char>(static_cast<unsigned char>(bits)); };
  if (character < 0x80) return {byte(character)};
  if (character < 0x800) return {byte(0xC0 | character >> 6), byte(0x80 | (character & 0x3F))};
  if (character < 0x10000)
    return {byte(0xE0 | character >> 12), byte(0x80 | (character >> 6 & 0x3F)), byte(0x80 | (character & 0x3F))};
  return {byte(0xF0 | character >> 18), byte(0x80 | (character >> 12 & 0x3F)), byte(0x80 | (character >> 6 & 0x3F)),
          byte(0x80 | (character & 0x3F))};
}

void addLackedCharacter(const std::string& text, const std::string& where, std::vector<std::string>& faults) {
  const std::optional<char32_t> lacked = lackedCharacter(text);
  if (!lacked) return;
  faults.push_back(fmt::format(
      "{}: found the character \"{}\" (U+{:04X}), which the font of pictures has not; allowed are the characters of "
      "DejaVu Sans: Latin, Greek and Cyrillic letters, mathematical signs and arrows among them; write it with these",
      where, printableLine(inUtf8(*lacked)), static_cast<std::uint32_t>(*lacked)));
}

/// Text of a fault if the card does not fit.
std::optional<std::string> cardFault(const Scene& scene, int width, int height) {
  if (!scene.titleCard) return std::nullopt;
  const CardLayout layout = layOutCard(*scene.titleCard, width, height);
  if (layout.fits) return std::nullopt;
  return fmt::format(
      "{}: title and subtitle take {} lines of the smallest text, {:.0f} pixels, in a picture of {}x{}; allowed is "
      "the height that there is; shorten them, or make the picture wider",
      scene.titleCard->titleWhere, layout.title.size() + layout.subtitle.size(), layout.height, width, height);
}

/// Captions that are shown at once, in the order of the file.
struct ShownAtOnce {
  std::vector<const Caption*> captions;
  std::vector<CaptionExtent> extents;

  void removeEnded(double time) {
    for (std::size_t i = captions.size(); i-- > 0;) {
      if (captions[i]->to > time) continue;
      captions.erase(captions.begin() + static_cast<std::ptrdiff_t>(i));
      extents.erase(extents.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
  void add(const Caption* caption, const CaptionExtent& extent) {
    const auto place = std::lower_bound(captions.begin(), captions.end(), caption) - captions.begin();
    captions.insert(captions.begin() + place, caption);
    extents.insert(extents.begin() + place, extent);
  }
};

std::vector<const Caption*> inOrderOfTime(const std::vector<Caption>& captions) {
  std::vector<const Caption*> sorted;
  for (const Caption& caption : captions) sorted.push_back(&caption);
  std::stable_sort(sorted.begin(), sorted.end(), [](const Caption* a, const Caption* b) { return a->from < b->from; });
  return sorted;
}

/// Text of a fault at the first caption that does not fit beside those that are shown then.
std::optional<std::string> captionFault(const Scene& scene, int width, int height) {
  ShownAtOnce shown;
  for (const Caption* caption : inOrderOfTime(scene.captions)) {
    shown.removeEnded(caption->from);
    shown.add(caption, leastExtent(*caption, width, height));
    const double needed = neededHeight(shown.extents, width, height);
    if (needed <= 1) continue;
    const std::size_t count = shown.captions.size();
    return fmt::format(
        "{}: {} shown at {} s, with {:.4g} times the height of a picture of {}x{} in the smallest text; allowed is the "
        "height that there is; show fewer at once, shorten them, or make the picture wider",
        caption->where, count == 1 ? "this caption is" : fmt::format("{} captions are", count), caption->from, needed,
        width, height);
  }
  return std::nullopt;
}

void addUnfitting(const Scene& scene, int width, int height, std::vector<std::string>& faults) {
  for (const auto& fault : {cardFault(scene, width, height), captionFault(scene, width, height)})
    if (fault) faults.push_back(*fault);
}

void throwIfAny(const std::vector<std::string>& faults) {
  if (faults.empty()) return;
  const std::size_t told = std::min(faults.size(), kMaxFaults);
  std::string text =
      fmt::format("{}", fmt::join(faults.begin(), faults.begin() + static_cast<std::ptrdiff_t>(told), "\n"));
  if (faults.size() > told) text += fmt::format("\nand {} more", faults.size() - told);
  throw Error::ofLines(ErrorKind::scene, text);
}

}  // namespace

void requireReadableWords(const Scene& scene) {
  std::vector<std::string> faults;
  for (const Caption& caption : scene.captions) addLackedCharacter(caption.text, caption.where, faults);
  if (scene.titleCard) {
    addLackedCharacter(scene.titleCard->title, scene.titleCard->titleWhere, faults);
    addLackedCharacter(scene.titleCard->subtitle, scene.titleCard->subtitleWhere, faults);
  }
  addUnfitting(scene, scene.output.width, scene.output.height, faults);
  throwIfAny(faults);
}

void requireRoomForWords(const Scene& scene, int width, int height) {
  std::vector<std::string> faults;
  addUnfitting(scene, width, height, faults);
  throwIfAny(faults);
}

}  // namespace cradle
