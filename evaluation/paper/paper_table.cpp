#include "paper/paper_table.h"

#include "scan_pairs.h"

#include <io/numbers.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bayesian_icp::evaluate {

namespace {

constexpr int num_objects = 6;
constexpr double online_sd = 0.004;
constexpr int paper_repeats = 10;

/** A coordinate's row of Table I; objects in the order of paperObjects(). */
struct PaperRow {
  std::array<double, num_objects> bayesian, bayesian_sd, online;
};

/** Maken, Ramos, Ott (2020), Table I [nats]. */
constexpr std::array<PaperRow, 6> table_1 = {{
    // x
    {{0.387, 0.118, 0.189, 0.619, 0.133, 0.086},
     {0.199, 0.078, 0.051, 0.044, 0.049, 0.011},
     {0.731, 0.078, 0.104, 1.938, 0.100, 0.643}},
    // y
    {{0.373, 0.163, 0.218, 1.117, 0.092, 0.082},
     {0.311, 0.168, 0.112, 0.222, 0.019, 0.016},
     {0.254, 0.312, 1.596, 1.845, 0.077, 0.062}},
    // z
    {{0.007, 0.020, 0.015, 0.015, 0.023, 0.008},
     {0.003, 0.006, 0.004, 0.000, 0.011, 0.001},
     {0.000, 0.000, 0.055, 0.027, 0.018, 0.000}},
    // roll
    {{0.040, 0.063, 0.105, 5.947, 0.425, 0.012},
     {0.017, 0.055, 0.019, 0.828, 0.022, 0.003},
     {0.078, 0.000, 0.166, 7.889, 0.571, 0.000}},
    // pitch
    {{0.084, 0.051, 0.335, 1.099, 0.098, 0.015},
     {0.038, 0.045, 0.016, 0.023, 0.027, 0.004},
     {0.454, 0.000, 0.572, 1.568, 0.081, 0.002}},
    // yaw
    {{8.849, 6.620, 5.467, 0.842, 6.457, 1.148},
     {6.113, 3.251, 4.926, 0.254, 1.062, 0.283},
     {39.689, 32.955, 370.697, 21.917, 13.438, 38.848}},
}};

} // namespace

Spread
spreadOf(const std::vector<double>& values)
{
  Spread spread;
  spread.num_values = static_cast<int>(values.size());
  double sum = 0.0, sum_of_squares = 0.0;
  for (const double value : values)
    if (std::isfinite(value)) {
      ++spread.num_finite;
      sum += value;
    }
  if (spread.num_finite == 0) {
    spread.mean = std::numeric_limits<double>::quiet_NaN();
    return spread;
  }
  spread.mean = sum / spread.num_finite;
  for (const double value : values)
    if (std::isfinite(value))
      sum_of_squares += (value - spread.mean) * (value - spread.mean);
  if (spread.num_finite > 1)
    spread.sd = std::sqrt(sum_of_squares / (spread.num_finite - 1));
  return spread;
}

std::string
shortText(double value)
{
  constexpr double most_with_decimals = 1000.0;
  if (std::isnan(value))
    return "-";
  return std::abs(value) < most_with_decimals ? io::fixedTextOf(value, 3)
                                              : io::textOf(value, 3);
}

std::string
textOf(const Spread& spread)
{
  if (spread.num_finite == 0)
    return spread.num_values > 0 ? "infinite" : "-";
  std::string text = shortText(spread.mean) + " ± " + shortText(spread.sd);
  if (spread.num_finite < spread.num_values)
    text += " (" + std::to_string(spread.num_finite) + " of " +
            std::to_string(spread.num_values) + " finite)";
  return text;
}

std::optional<PaperCell>
paperCell(const std::string& object, int k)
{
  const auto& objects = paperObjects();
  const auto found = std::find(objects.begin(), objects.end(), object);
  if (found == objects.end())
    return std::nullopt;
  const auto column = static_cast<std::size_t>(found - objects.begin());
  const PaperRow& row = table_1[static_cast<std::size_t>(k)];
  return PaperCell{
      {row.bayesian[column], row.bayesian_sd[column], paper_repeats, paper_repeats},
      {row.online[column], online_sd, paper_repeats, paper_repeats}};
}

Order
orderOf(const Spread& bayesian, const Spread& online)
{
  if (bayesian.num_finite == 0 && online.num_finite == 0)
    return Order::Undecided;
  if (bayesian.num_finite == 0)
    return Order::OnlineLower;
  if (online.num_finite == 0)
    return Order::BayesianLower;
  if (std::abs(bayesian.mean - online.mean) <= std::hypot(bayesian.sd, online.sd))
    return Order::Undecided;
  return bayesian.mean < online.mean ? Order::BayesianLower : Order::OnlineLower;
}

const char*
toString(Order order)
{
  switch (order) {
  case Order::BayesianLower:
    return "Bayesian ICP";
  case Order::OnlineLower:
    return "Online-ICP";
  case Order::Undecided:
    break;
  }
  return "undecided";
}

const char*
agreement(Order paper, Order ours)
{
  if (paper == Order::Undecided || ours == Order::Undecided)
    return "undecided";
  return paper == ours ? "yes" : "no";
}

} // namespace bayesian_icp::evaluate
