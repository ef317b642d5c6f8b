// The optimisers of SGD-ICP against closed forms, and against their published update
// rules in 40-digit decimal arithmetic (Python's decimal module).
#include <bayesian_icp/descent_optimizer.h>

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>

namespace bayesian_icp {
namespace {

constexpr double own_step_size = std::numeric_limits<double>::quiet_NaN();

/** Positions after 1, 2, ... steps down a x^2 / 2 from 1, a different in each
 * coordinate. */
class Descent {
public:
  Descent(SgdOptimizer optimizer, double step_size)
  : optimizer_(makeDescentOptimizer(optimizer, step_size))
  {
    curvature_ << 1.0, 0.01, 0.5, 1e-4, 1.5, 0.1;
  }

  const Vector6d&
  after(int num_steps)
  {
    for (; step_ < num_steps; ++step_)
      position_ += optimizer_->step(curvature_.cwiseProduct(position_));
    return position_;
  }

  const Vector6d&
  curvature() const
  {
    return curvature_;
  }

private:
  std::unique_ptr<DescentOptimizer> optimizer_;
  Vector6d curvature_;
  Vector6d position_ = Vector6d::Ones();
  int step_ = 0;
};

/** Fifty additions of numbers up to 1 round by less than 50 * 1.1e-16 each time. */
constexpr double rounding = 1e-14;

TEST(DescentOptimizer, FixedStepsShrinkEveryCoordinateByOneMinusStepTimesCurvature)
{
  Descent descent(SgdOptimizer::FixedStep, 0.8);
  for (const int t : {1, 2, 10, 50})
    for (int k = 0; k < 6; ++k)
      EXPECT_NEAR(descent.after(t)[k],
                  std::pow(1.0 - 0.8 * descent.curvature()[k], t),
                  rounding);
}

/** x_t+1 = (1.8 - h a) x_t - 0.8 x_t-1 with x_-1 = x_0 = 1, by its characteristic
 * roots. */
double
momentumPosition(double step_times_curvature, int t)
{
  const std::complex<double> half(0.5 * (1.8 - step_times_curvature), 0.0);
  const std::complex<double> root = std::sqrt(half * half - 0.8);
  const std::complex<double> first = half + root, second = half - root;
  const double x1 = 1.0 - step_times_curvature;
  return ((x1 - second) / (first - second) * std::pow(first, t) -
          (x1 - first) / (first - second) * std::pow(second, t))
      .real();
}

TEST(DescentOptimizer, MomentumFollowsTheRootsOfItsRecursion)
{
  Descent descent(SgdOptimizer::Momentum, 0.3);
  for (const int t : {1, 2, 10, 50})
    for (int k = 0; k < 6; ++k)
      EXPECT_NEAR(descent.after(t)[k],
                  momentumPosition(0.3 * descent.curvature()[k], t),
                  100.0 * rounding) // roots that are close to each other
          << k << " after " << t;
}

struct Sequence {
  SgdOptimizer optimizer;
  /** Coordinate, of curvature 1 and 0.01. */
  int coordinate;
  /** After 1, 2, 3, 10, 50 steps. */
  double positions[5];
};

TEST(DescentOptimizer, AdaptiveOptimisersFollowTheirPublishedRules)
{
  const Sequence sequences[] = {{SgdOptimizer::AdaDelta,
                                 0,
                                 {0.8438262381113939,
                                  0.69987108254607699,
                                  0.5734819765941267,
                                  0.12205250671404168,
                                  2.0788768393356309e-06}},
                                {SgdOptimizer::AdaDelta,
                                 1,
                                 {0.99001994019930251,
                                  0.9801383082725128,
                                  0.97035420297777208,
                                  0.90452139946471832,
                                  0.60515658098994396}},
                                {SgdOptimizer::Adam,
                                 0,
                                 {0.90000000099999999,
                                  0.80041222971233739,
                                  0.70158627450441424,
                                  0.076249160619753981,
                                  -0.0048182194265359536}},
                                {SgdOptimizer::Adam,
                                 1,
                                 {0.90000009999990005,
                                  0.80041243178008536,
                                  0.70158658306424215,
                                  0.0762501531614318,
                                  -0.004817467795031595}},
                                {SgdOptimizer::RmsProp,
                                 0,
                                 {0.96853416122362235,
                                  0.94600437373550061,
                                  0.92730431396434854,
                                  0.83240828827561819,
                                  0.45992377673854978}},
                                {SgdOptimizer::RmsProp,
                                 1,
                                 {0.99685341612236222,
                                  0.99373051956128711,
                                  0.99062952753902256,
                                  0.96942531798853382,
                                  0.85818385899945915}}};
  const int steps[] = {1, 2, 3, 10, 50};
  for (const Sequence& sequence : sequences) {
    Descent descent(sequence.optimizer, own_step_size);
    for (int i = 0; i < 5; ++i)
      EXPECT_NEAR(
          descent.after(steps[i])[sequence.coordinate], sequence.positions[i], rounding)
          << toString(sequence.optimizer) << " after " << steps[i];
  }
}

TEST(DescentOptimizer, HasTheStepSizesOfTheAuthors)
{
  EXPECT_EQ(defaultStepSize(SgdOptimizer::FixedStep), 1.0);
  EXPECT_EQ(defaultStepSize(SgdOptimizer::Momentum), 1.0);
  EXPECT_EQ(defaultStepSize(SgdOptimizer::Adam), 0.1);
  EXPECT_EQ(defaultStepSize(SgdOptimizer::RmsProp), 0.01);
  EXPECT_TRUE(std::isnan(defaultStepSize(SgdOptimizer::AdaDelta)));
  const Vector6d g = Vector6d::Constant(0.7);
  EXPECT_EQ(makeDescentOptimizer(SgdOptimizer::FixedStep, own_step_size)->step(g), -g);
  EXPECT_EQ(makeDescentOptimizer(SgdOptimizer::AdaDelta, 3.0)->step(g),
            makeDescentOptimizer(SgdOptimizer::AdaDelta, own_step_size)->step(g));
}

} // namespace
} // namespace bayesian_icp
