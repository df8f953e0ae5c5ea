#include "study/stability/stability_map.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "core/csv_field.h"
#include "core/error.h"

namespace cradle {
namespace {

// In the order of CurveKind.
constexpr std::array<const char*, 4> kKindNames = {"theory", "measured", "series", "dots"};

std::string cellLines(const StabilityMap& map, const MapPanel& panel) {
  if (panel.cells.empty()) return "";
  const std::size_t columns = map.x.values.size();
  CRADLE_CHECK(panel.cells.size() == columns * map.y.values.size());
  std::string text;
  for (std::size_t i = 0; i < panel.cells.size(); ++i) {
    const double cell = panel.cells[i], x = map.x.values[i % columns], y = map.y.values[i / columns];
    if (map.outcomes.empty())
      text += fmt::format("{},cell,,{},{},{}\n", csvField(panel.title), x, y, cell);
    else if (!std::isnan(cell))
      text += fmt::format("{},cell,{},{},{}\n", csvField(panel.title),
                          csvField(map.outcomes.at(static_cast<std::size_t>(cell)).name), x, y);
  }
  return text;
}

std::string curveLines(const StabilityMap& map, const MapPanel& panel) {
  const char* const noNumber = map.outcomes.empty() && !panel.cells.empty() ? "," : "";
  std::string text;
  for (const MapCurve& curve : panel.curves)
    for (const MapPoint& point : curve.points)
      if (std::isfinite(point.x) && std::isfinite(point.y))
        text += fmt::format("{},{},{},{},{}{}\n", csvField(panel.title),
                            kKindNames.at(static_cast<std::size_t>(curve.kind)), csvField(curve.name), point.x, point.y,
                            noNumber);
  return text;
}

bool hasNumbers(const StabilityMap& map) {
  if (!map.outcomes.empty()) return false;
  for (const MapPanel& panel : map.panels)
    if (!panel.cells.empty()) return true;
  return false;
}

}  // namespace

Axis linearAxis(const std::string& name, const std::string& unit, const std::vector<double>& values) {
  return {{name, unit, false}, values};
}

Axis logarithmicAxis(const std::string& name, const std::string& unit, const std::vector<double>& values) {
  return {{name, unit, true}, values};
}

std::vector<Outcome> stabilityOutcomes() {
  return {{"stable", "#a9d3ee"}, {"inaccurate", "#f7dc8a"}, {"unstable", "#e79a7c"}};
}

std::vector<double> evenlySpaced(double first, double last, int count) {
  CRADLE_CHECK(count >= 2);
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(first + (last - first) * i / (count - 1));
  return values;
}

std::vector<double> logarithmicallySpaced(double first, double last, int count) {
  std::vector<double> values = evenlySpaced(std::log10(first), std::log10(last), count);
  for (double& value : values) value = std::pow(10, value);
  return values;
}

std::string labelOf(const Quantity& quantity) {
  return quantity.unit.empty() ? quantity.name : fmt::format("{} ({})", quantity.name, quantity.unit);
}

std::string tableOf(const StabilityMap& map) {
  std::string text = fmt::format("# {}\n# {}\n# {}\npanel,kind,name,{},{}", map.title, map.subtitle, map.paragraph,
                                 csvField(labelOf(map.x.quantity)), csvField(labelOf(map.y.quantity)));
  text += hasNumbers(map) ? fmt::format(",{}\n", csvField(labelOf(map.cell))) : "\n";
  for (const MapPanel& panel : map.panels) text += cellLines(map, panel) + curveLines(map, panel);
  return text;
}

}  // namespace cradle
