/** \file
 * \brief Options that are one of a few named values.
 */
#pragma once

#include <bayesian_icp/descent_optimizer.h>
#include <bayesian_icp/options.h>

#include <array>
#include <string>

namespace bayesian_icp::app {

/** \brief All values of an enumeration; its toString() names them. */
inline std::array<Preset, 3>
choicesOf(Preset)
{
  return {Preset::Paper, Preset::Exact, Preset::Calibrated};
}

inline std::array<PriorFrame, 3>
choicesOf(PriorFrame)
{
  return {PriorFrame::Origin, PriorFrame::SourceCentroid, PriorFrame::Automatic};
}

inline std::array<MiniBatchSampling, 2>
choicesOf(MiniBatchSampling)
{
  return {MiniBatchSampling::WithReplacement, MiniBatchSampling::ShuffledEpochs};
}

inline std::array<Residual, 3>
choicesOf(Residual)
{
  return {Residual::PointToPoint,
          Residual::PointToPlane,
          Residual::DistributionToDistribution};
}

inline std::array<CovarianceRegularization, 3>
choicesOf(CovarianceRegularization)
{
  return {CovarianceRegularization::Plane,
          CovarianceRegularization::Frobenius,
          CovarianceRegularization::None};
}

inline std::array<ExactSteps, 5>
choicesOf(ExactSteps)
{
  return {ExactSteps::Automatic,
          ExactSteps::Langevin,
          ExactSteps::Metropolis,
          ExactSteps::SteinGradient,
          ExactSteps::SteinNewton};
}

inline std::array<RobustKernel, 3>
choicesOf(RobustKernel)
{
  return {RobustKernel::None, RobustKernel::Huber, RobustKernel::Tukey};
}

inline std::array<SgdOptimizer, 5>
choicesOf(SgdOptimizer)
{
  return {SgdOptimizer::FixedStep,
          SgdOptimizer::Momentum,
          SgdOptimizer::AdaDelta,
          SgdOptimizer::Adam,
          SgdOptimizer::RmsProp};
}

/** \brief "one, two or three". */
template <typename Choice>
std::string
namesOfChoices(Choice choice)
{
  const auto choices = choicesOf(choice);
  std::string names;
  for (std::size_t i = 0; i < choices.size(); ++i)
    names += (i == 0                   ? ""
              : i + 1 < choices.size() ? ", "
                                       : " or ") +
             std::string(toString(choices[i]));
  return names;
}

/** \brief Set \p choice to the value of this name.
 * \return whether there is one */
template <typename Choice>
bool
readChoice(const std::string& name, Choice& choice)
{
  for (const Choice candidate : choicesOf(choice))
    if (name == toString(candidate)) {
      choice = candidate;
      return true;
    }
  return false;
}

} // namespace bayesian_icp::app
