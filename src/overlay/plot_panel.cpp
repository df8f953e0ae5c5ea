#include "overlay/plot_panel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "image/font.h"

namespace cradle {
namespace {

// Of the picture's height.
constexpr double kWidth = 0.62, kHeight = 0.30, kFromEdge = 0.03, kPadding = 0.014;
constexpr double kText = 0.028, kCurve = 0.0042, kRule = 0.0016;
constexpr double kValueColumn = 0.105;  // of the numbers beside the curves
constexpr double kLineHeight = 1.45;    // in em
constexpr double kBesideRule = 0.4;     // em, from a value's number to the curves
constexpr double kHeadroom = 0.06;      // of the range of values, above and below
constexpr int kTimeNumbers = 5, kValueNumbers = 4;
constexpr double kTickRounding = 1e-9;  // of a step: an end that is a round number but for rounding has its rule
constexpr double kPointsPerPixel = 2;   // of a curve
const Ink kPanel{{18, 22, 30}, 0.88}, kWords{{235, 238, 242}, 1}, kRules{{235, 238, 242}, 0.28};

struct Layout {
  PlotArea area;
  PicturePoint panelTopLeft, panelBottomRight;
  TextSize text;
};

/// A little more than what the values span; some of a size that fits if they are all the same.
std::pair<double, double> rangeOf(const PlotContent& content) {
  double low = 0, high = 0;
  bool isFirst = true;
  for (const PlotCurve& curve : content.curves)
    for (const double value : curve.values) {
      low = isFirst ? value : std::min(low, value);
      high = isFirst ? value : std::max(high, value);
      isFirst = false;
    }
  const double least = 1e-12 * std::max({std::abs(low), std::abs(high), 1e-300});
  const double margin = high - low > least ? kHeadroom * (high - low) : std::max(std::abs(low), 1e-15) / 2;
  return {low - margin, high + margin};
}

std::string numberText(double number, double step) {
  if (std::abs(number) < step / 2) return "0";
  return std::abs(number) >= 1e5 || step < 1e-3 ? fmt::format("{:.3g}", number) : fmt::format("{:g}", number);
}

/// A number beside, or below, its rule.
struct PlotLabel {
  double number;
  std::string text;
};

std::vector<PlotLabel> labelsOf(double low, double high, int wanted) {
  const std::vector<double> numbers = roundNumbers(low, high, wanted);
  const double step = numbers.size() > 1 ? numbers[1] - numbers[0] : 1;
  std::vector<PlotLabel> labels;
  for (const double number : numbers) labels.push_back({number, numberText(number, step)});
  return labels;
}

std::vector<PlotLabel> valueLabels(const PlotArea& area) {
  return labelsOf(area.lowestValue, area.highestValue, kValueNumbers);
}

Layout layOut(const PlotContent& content, int width, int height) {
  Layout layout;
  const double unit = height, padding = kPadding * unit;
  layout.text = crispTextSize(kText * unit);
  const double line = kLineHeight * layout.text.em;
  std::tie(layout.panelTopLeft, layout.panelBottomRight) =
      plotPanelAt(content.corner, content.upperEdge, width, height);
  PlotArea& area = layout.area;
  area.right = std::round(layout.panelBottomRight.x - 2 * padding);
  area.top = std::round(layout.panelTopLeft.y + padding + line);
  area.bottom = std::round(layout.panelBottomRight.y - padding / 2 - line);
  area.firstTime = content.times.front();
  area.lastTime = std::max(content.times.back(), area.firstTime + 1e-12 * std::max(1.0, area.firstTime));
  std::tie(area.lowestValue, area.highestValue) = rangeOf(content);
  double column = kValueColumn * unit;  // wider for numbers with an exponent
  for (const PlotLabel& label : valueLabels(area))
    column = std::max(column, textWidth(label.text, layout.text) + kBesideRule * layout.text.em);
  area.left = std::round(layout.panelTopLeft.x + padding + column);
  return layout;
}

void drawRules(Canvas& canvas, const Layout& layout) {
  const PlotArea& area = layout.area;
  const double thickness = std::max(kRule * canvas.height(), 1.0);
  const auto rule = [&](const PicturePoint& low, const PicturePoint& high) { canvas.rectangle(low, high, 0, kRules); };
  // From the last one, which has the unit, to the first, leaving out those without room.
  std::vector<PlotLabel> times = labelsOf(area.firstTime, area.lastTime, kTimeNumbers);
  double end = layout.panelBottomRight.x - layout.text.em / 2;  // of the room
  for (std::size_t i = times.size(); i-- > 0;) {
    const double x = std::round(area.at(times[i].number, 0).x);
    rule({x, area.top}, {x + thickness, area.bottom});
    const bool isLast = i + 1 == times.size();
    const std::string text = times[i].text + (isLast ? " s" : "");
    const double width = textWidth(text, layout.text);
    const double start = isLast ? std::min(x - width / 2, end - width) : x - width / 2;
    if (start + width > end) continue;
    drawText(canvas, text, layout.text, {start, area.bottom + 1.05 * layout.text.em}, kWords);
    end = start - layout.text.em / 2;
  }
  for (const PlotLabel& label : valueLabels(area)) {
    const double y = std::round(area.at(0, label.number).y);
    rule({area.left, y}, {area.right, y + thickness});
    const double width = textWidth(label.text, layout.text);
    const double baseline = std::max(y + layout.text.ascent / 2, area.top + layout.text.ascent);  // below the title
    drawText(canvas, label.text, layout.text, {area.left - kBesideRule * layout.text.em - width, baseline}, kWords);
  }
}

/// The title, and the names of more than one curve in their colours, from right to left.
void drawHead(Canvas& canvas, const PlotContent& content, const Layout& layout) {
  const double y = layout.area.top - 0.45 * layout.text.em;
  const double start = layout.panelTopLeft.x + kPadding * canvas.height();
  drawText(canvas, fittedText(content.title, layout.text, layout.area.right - start), layout.text, {start, y}, kWords);
  if (content.curves.size() < 2) return;
  double x = layout.area.right;
  for (auto curve = content.curves.rbegin(); curve != content.curves.rend(); ++curve) {
    x -= textWidth(curve->name, layout.text);
    drawText(canvas, curve->name, layout.text, {x, y}, curve->ink);
    x -= 0.7 * layout.text.em;
  }
}

}  // namespace

std::pair<PicturePoint, PicturePoint> plotPanelAt(PlotCorner corner, double upperEdge, int width, int height) {
  const double edge = std::round(kFromEdge * height), tall = std::round(kHeight * height);
  const double wide = std::round(std::min(kWidth * height, width - 2 * edge));
  const double left = corner == PlotCorner::lowerLeft ? edge : width - edge - wide;
  const double top = corner == PlotCorner::upperRight ? std::max(edge, std::round(upperEdge)) : height - edge - tall;
  return {{left, top}, {left + wide, top + tall}};
}

PicturePoint PlotArea::at(double time, double value) const {
  return {left + (right - left) * (time - firstTime) / (lastTime - firstTime),
          bottom - (bottom - top) * (value - lowestValue) / (highestValue - lowestValue)};
}

PlotArea plotAreaOf(const PlotContent& content, int width, int height) {
  return layOut(content, width, height).area;
}

std::vector<double> roundNumbers(double low, double high, int wanted) {
  const double raw = (high - low) / wanted, power = std::pow(10.0, std::floor(std::log10(raw)));
  const double step = power * (raw / power > 7 ? 10 : raw / power > 3 ? 5 : raw / power > 1.5 ? 2 : 1);
  const double first = std::ceil(low / step), room = (high - first * step) / step + kTickRounding;
  std::vector<double> numbers;
  if (!(room >= 0 && room <= 2 * wanted)) return numbers;  // none, or the range is lost beside the numbers' rounding
  for (int i = 0; i <= static_cast<int>(room); ++i) {
    const double number = (first + i) * step;
    if (numbers.empty() || number > numbers.back()) numbers.push_back(number);
  }
  return numbers;
}

void drawPlot(Canvas& canvas, const PlotContent& content, std::size_t now) {
  const Layout layout = layOut(content, canvas.width(), canvas.height());
  const double thickness = std::max(kCurve * canvas.height(), 1.0);
  canvas.rectangle(layout.panelTopLeft, layout.panelBottomRight, kPadding * canvas.height(), kPanel);
  drawRules(canvas, layout);
  drawHead(canvas, content, layout);
  const double points = kPointsPerPixel * (layout.area.right - layout.area.left);
  const auto stride = static_cast<std::size_t>(std::max(1.0, static_cast<double>(content.times.size()) / points));
  for (const PlotCurve& curve : content.curves) {
    std::vector<LinePoint> line;
    for (std::size_t i = 0; i < now; i += stride)
      line.push_back({layout.area.at(content.times[i], curve.values[i]), thickness});
    line.push_back({layout.area.at(content.times[now], curve.values[now]), thickness});
    canvas.line(line, curve.ink);
    canvas.disc(line.back().place, 1.5 * thickness, curve.ink);
  }
}

}  // namespace cradle
