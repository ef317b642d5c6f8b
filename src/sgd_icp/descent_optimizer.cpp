#include "options/enumerator_names.h"

#include <bayesian_icp/descent_optimizer.h>

#include <cmath>
#include <limits>

namespace bayesian_icp {

namespace {

/** average <- decay_rate average + (1 - decay_rate) value. */
void
updateAverage(double decay_rate, const Vector6d& value, Vector6d& average)
{
  average = decay_rate * average + (1.0 - decay_rate) * value;
}

class Momentum : public DescentOptimizer {
public:
  Momentum(double share_kept, double step_size)
  : share_kept_(share_kept)
  , step_size_(step_size)
  {}

  Vector6d
  step(const Vector6d& gradient) override
  {
    momentum_ = share_kept_ * momentum_ + step_size_ * gradient;
    return -momentum_;
  }

private:
  double share_kept_;
  double step_size_;
  Vector6d momentum_ = Vector6d::Zero();
};

class AdaDelta : public DescentOptimizer {
public:
  Vector6d
  step(const Vector6d& gradient) override
  {
    constexpr double decay_rate = 0.96;
    constexpr double constant = 1e-3;
    updateAverage(decay_rate, gradient.cwiseAbs2(), mean_square_gradient_);
    const Vector6d ratio = ((mean_square_step_.array() + constant) /
                            (mean_square_gradient_.array() + constant))
                               .sqrt();
    Vector6d step = -ratio.cwiseProduct(gradient);
    updateAverage(decay_rate, step.cwiseAbs2(), mean_square_step_);
    return step;
  }

private:
  Vector6d mean_square_gradient_ = Vector6d::Zero();
  Vector6d mean_square_step_ = Vector6d::Zero();
};

class Adam : public DescentOptimizer {
public:
  explicit Adam(double step_size) : step_size_(step_size) {}

  Vector6d
  step(const Vector6d& gradient) override
  {
    constexpr double mean_decay_rate = 0.9;
    constexpr double square_decay_rate = 0.999;
    constexpr double constant = 1e-8;
    updateAverage(mean_decay_rate, gradient, mean_gradient_);
    updateAverage(square_decay_rate, gradient.cwiseAbs2(), mean_square_gradient_);
    mean_bias_ *= mean_decay_rate;
    square_bias_ *= square_decay_rate;
    const Vector6d mean = mean_gradient_ / (1.0 - mean_bias_);
    const Vector6d square = mean_square_gradient_ / (1.0 - square_bias_);
    return -step_size_ * (mean.array() / (square.array().sqrt() + constant)).matrix();
  }

private:
  double step_size_;
  double mean_bias_ = 1.0;
  double square_bias_ = 1.0;
  Vector6d mean_gradient_ = Vector6d::Zero();
  Vector6d mean_square_gradient_ = Vector6d::Zero();
};

class RmsProp : public DescentOptimizer {
public:
  explicit RmsProp(double step_size) : step_size_(step_size) {}

  Vector6d
  step(const Vector6d& gradient) override
  {
    constexpr double decay_rate = 0.9;
    constexpr double constant = 1e-3;
    updateAverage(decay_rate, gradient.cwiseAbs2(), mean_square_gradient_);
    return -step_size_ *
           (gradient.array() / (mean_square_gradient_.array() + constant).sqrt())
               .matrix();
  }

private:
  double step_size_;
  Vector6d mean_square_gradient_ = Vector6d::Zero();
};

} // namespace

DescentOptimizer::~DescentOptimizer() = default;

const char*
toString(SgdOptimizer optimizer)
{
  return nameOf(optimizer, {"fixed", "momentum", "adadelta", "adam", "rmsprop"});
}

double
defaultStepSize(SgdOptimizer optimizer)
{
  switch (optimizer) {
  case SgdOptimizer::FixedStep:
  case SgdOptimizer::Momentum:
    return 1.0;
  case SgdOptimizer::Adam:
    return 0.1;
  case SgdOptimizer::RmsProp:
    return 0.01;
  case SgdOptimizer::AdaDelta:
    break;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

std::unique_ptr<DescentOptimizer>
makeDescentOptimizer(SgdOptimizer optimizer, double step_size)
{
  const double size = std::isnan(step_size) ? defaultStepSize(optimizer) : step_size;
  switch (optimizer) {
  case SgdOptimizer::FixedStep:
    return std::make_unique<Momentum>(0.0, size);
  case SgdOptimizer::Momentum:
    return std::make_unique<Momentum>(0.8, size);
  case SgdOptimizer::AdaDelta:
    return std::make_unique<AdaDelta>();
  case SgdOptimizer::RmsProp:
    return std::make_unique<RmsProp>(size);
  case SgdOptimizer::Adam:
    break;
  }
  return std::make_unique<Adam>(size);
}

} // namespace bayesian_icp
