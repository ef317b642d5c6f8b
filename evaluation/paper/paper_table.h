/** \file
 * \brief Table I of the paper, and what of it can be compared with ours: orders.
 */
#pragma once

#include <io/coordinates.h>

#include <optional>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

using app::coordinate_names;

/** \brief Mean and standard deviation over runs. */
struct Spread {
  /** Over the finite values; NaN if there are none. */
  double mean = 0.0;
  double sd = 0.0;
  int num_finite = 0;
  int num_values = 0;
};

/** \brief The deviation is over num_finite - 1, zero for one value. */
Spread
spreadOf(const std::vector<double>& values);

/** \brief "0.387 ± 0.199"; says how many values were finite if not all, "infinite" if
 * none. */
std::string
textOf(const Spread& spread);

/** \brief A number for people: three decimals, or three digits of a large one. */
std::string
shortText(double value);

/** \brief KL of one object and coordinate in the paper [nats]. */
struct PaperCell {
  Spread bayesian;
  /** Its deviations are below 0.004: that is what is here. */
  Spread online;
};

/** \brief The cell of an object of paperObjects(), and of coordinate \p k; empty for
 * another name. */
std::optional<PaperCell>
paperCell(const std::string& object, int k);

/** \brief Which of two methods is nearer to the baseline. */
enum class Order { BayesianLower, OnlineLower, Undecided };

/** \brief Undecided where the means differ by no more than the root of the summed
 * variances. A method all of whose divergences are infinite is the higher one;
 * undecided if that is so of both. */
Order
orderOf(const Spread& bayesian, const Spread& online);

/** \brief "Bayesian ICP", "Online-ICP" or "undecided". */
const char*
toString(Order order);

/** \brief "yes", "no", or "undecided" if one of the two orders is. */
const char*
agreement(Order paper, Order ours);

} // namespace bayesian_icp::evaluate
