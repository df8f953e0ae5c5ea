#include "overlay/label_places.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cradle {
namespace {

const LabelRoom kLabelRoom{{10, 10, 630, 350}};
constexpr double kLabelsGap = 2, kLabelHeight = 20;

Label labelAt(double x, double y, double width = 100) {
  return {{x, y}, width, kLabelHeight, x + 15, y - 60};
}

bool overlap(const Label& a, const Label& b) {
  return a.left < b.left + b.width && b.left < a.left + a.width && a.top < b.top + b.height && b.top < a.top + a.height;
}

void expectApartInRoom(const std::vector<Label>& labels, double time = 0) {
  for (std::size_t i = 0; i < labels.size(); ++i) {
    EXPECT_GE(labels[i].top, kLabelRoom.top) << time;
    EXPECT_LE(labels[i].top + labels[i].height, kLabelRoom.bottom) << time;
    for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(overlap(labels[i], labels[j])) << i << " " << j << " at " << time;
  }
}

TEST(LabelPlaces, LabelsThatAreApartStay) {
  std::vector<Label> labels = {labelAt(100, 200), labelAt(300, 205), labelAt(110, 300)};
  const std::vector<Label> before = labels;
  EXPECT_TRUE(stackLabels(kLabelRoom, kLabelsGap, labels));
  for (std::size_t i = 0; i < labels.size(); ++i) {
    EXPECT_EQ(labels[i].left, before[i].left);
    EXPECT_EQ(labels[i].top, before[i].top);
  }
}

// Five things in a row, each as wide as a fifth of its label: the right one's label stays, the others are above it.
TEST(LabelPlaces, LabelsOfARowAreStairs) {
  std::vector<Label> labels;
  for (int i = 0; i < 5; ++i) labels.push_back(labelAt(200 + 20 * i, 200));
  EXPECT_TRUE(stackLabels(kLabelRoom, kLabelsGap, labels));
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_DOUBLE_EQ(labels[i].top, 140 - (kLabelHeight + kLabelsGap) * static_cast<double>(4 - i));
}

TEST(LabelPlaces, LabelsThatWouldLeaveTheRoomAreBelow) {
  std::vector<Label> labels;
  for (int i = 0; i < 5; ++i) labels.push_back(labelAt(200 + 20 * i, 80));
  EXPECT_TRUE(stackLabels(kLabelRoom, kLabelsGap, labels));
  expectApartInRoom(labels);
  EXPECT_EQ(labels[0].top, kLabelRoom.top);
}

// 340 pixels hold 15 labels of 20 with gaps of 2.
TEST(LabelPlaces, LabelsThatDoNotFitAreLeftAlone) {
  std::vector<Label> labels(15, labelAt(300, 200));
  EXPECT_TRUE(stackLabels(kLabelRoom, kLabelsGap, labels));
  expectApartInRoom(labels);
  labels.assign(16, labelAt(300, 200));
  EXPECT_FALSE(stackLabels(kLabelRoom, kLabelsGap, labels));
  EXPECT_EQ(labels[3].top, 140);
}

// Two go round each other, one to and fro, at 4 pixels from picture to picture at most. A label is as fast as what it
// belongs to, and as fast again for each that it makes way for: it rises by its height and the gap while another comes
// nearer by its height. Where two change places one above the other, both go by as much at once: that is counted.
TEST(LabelPlaces, LabelsOfWhatMovesSlowlyMoveSlowly) {
  std::vector<Label> before;
  int jumps = 0;
  for (int picture = 0; picture <= 400; ++picture) {
    const double angle = 2 * M_PI * picture / 200;
    std::vector<Label> labels = {labelAt(300 + 120 * std::cos(angle), 200 + 60 * std::sin(angle)),
                                 labelAt(300 - 120 * std::cos(angle), 200 - 60 * std::sin(angle)),
                                 labelAt(320 + 127 * std::sin(angle), 190)};
    ASSERT_TRUE(stackLabels(kLabelRoom, kLabelsGap, labels));
    expectApartInRoom(labels, picture);
    bool hasJumped = false;
    for (std::size_t i = 0; i < before.size(); ++i)
      hasJumped = hasJumped || std::abs(labels[i].top - before[i].top) > 20;
    jumps += hasJumped;
    before = labels;
  }
  EXPECT_LE(jumps, 12);  // three pairs that change places four times each
}

// A panel of 200 x 100 pixels: what comes from its left, at its height, is pushed below it before it meets it.
TEST(LabelPlaces, LabelsStayBelowPanels) {
  LabelRoom room = kLabelRoom;
  room.panels = {{400, 10, 600, 110}};
  double last = 38;
  for (double x = 200; x < 450; x += 2) {
    std::vector<Label> labels = {labelAt(x, 120), labelAt(x + 3, 110)};
    ASSERT_TRUE(stackLabels(room, kLabelsGap, labels));
    for (const Label& label : labels)
      EXPECT_TRUE(label.left + label.width <= 400 || label.top >= 110 + kLabelsGap) << label.left << " " << label.top;
    EXPECT_LE(std::abs(labels[1].top - last), 15) << x;
    last = labels[1].top;
  }
}

TEST(LabelPlaces, RowsAreFilledInOrder) {
  std::vector<Label> labels(7, labelAt(0, 0, 300));
  labels[2].height = 30;
  EXPECT_DOUBLE_EQ(putInRows(kLabelRoom, kLabelsGap, labels), 20 + 2 + 30 + 2 + 20 + 2 + 20);
  EXPECT_EQ(labels[1].left, 312);
  EXPECT_EQ(labels[1].top, 10);
  EXPECT_EQ(labels[2].left, 10);
  EXPECT_EQ(labels[4].top, 64);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    EXPECT_LE(labels[i].left + labels[i].width, kLabelRoom.right);
    for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(overlap(labels[i], labels[j]));
  }
}

}  // namespace
}  // namespace cradle
