/** \file
 * \brief Fuzzes the registration, by the library without PCL and by the PCL class: any
 * clouds, any options.
 */
#include "fuzz_input.h"
#include "registration_input.h"

#include <pcl/console/print.h>
#include <pcl/registration/bayesian_icp.h>
#include <pcl/point_types.h>

namespace {

using namespace bayesian_icp;
using Cloud = pcl::PointCloud<pcl::PointXYZ>;

/** Cancels a run that takes too many steps. */
ProgressCallback
limitSteps(const fuzz::RegistrationInput& input)
{
  return [num_left = input.max_num_steps](const Progress&) mutable {
    return --num_left > 0;
  };
}

/** What holds of every estimate, whatever its input was. */
void
checkEstimate(const Summary& summary, const PoseMatrix& samples)
{
  fuzz::require(summary.status != Status::NotRun, "a run has a status");
  fuzz::require(!summary.message.empty(), "a status has a message");
  fuzz::require(summary.num_draws == samples.rows(), "draws are counted");
  fuzz::require(samples.allFinite(), "draws are finite");
  const Matrix6d& covariance = summary.covariance(CovarianceConvention::Parameters);
  if (summary.num_draws == 0)
    fuzz::require(summary.mean.array().isNaN().all(), "no posterior is NaN");
  else
    fuzz::require(summary.mean.allFinite(), "the mean of draws is finite");
  if (summary.num_draws < 2)
    fuzz::require(covariance.array().isNaN().all(), "one draw has no covariance");
  else if (hasUsableMean(summary.status))
    fuzz::require(covariance.allFinite(), "a usable posterior has a covariance");
}

void
registerByCore(const fuzz::RegistrationInput& input)
{
  const PosteriorEstimate estimate = estimatePosterior(input.source.cast<double>(),
                                                       input.target.cast<double>(),
                                                       input.guess,
                                                       input.options,
                                                       limitSteps(input));
  checkEstimate(estimate.summary, estimate.samples);
}

Cloud::Ptr
pclCloudOf(const Eigen::Matrix3Xf& points)
{
  Cloud::Ptr cloud(new Cloud);
  for (const Eigen::Vector3f point : points.colwise())
    cloud->push_back({point[0], point[1], point[2]});
  return cloud;
}

void
registerByClass(const fuzz::RegistrationInput& input)
{
  pcl::BayesianIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp;
  icp.setInputSource(pclCloudOf(input.source));
  icp.setInputTarget(pclCloudOf(input.target));
  icp.setMaxCorrespondenceDistance(input.gate);
  icp.setMaximumIterations(input.icp_iterations);
  icp.setUseReciprocalCorrespondences(input.is_reciprocal);
  icp.setUseMeanAsFinalTransformation(input.use_mean);
  icp.setOptions(input.options);
  icp.setProgressCallback(limitSteps(input));
  Cloud output;
  icp.align(output, matrixOf(input.guess).cast<float>());
  if (input.source.cols() == 0 || input.target.cols() == 0)
    return; // PCL keeps no empty cloud and does not call the class
  fuzz::require(output.size() == std::size_t(input.source.cols()),
                "all points come out");
  checkEstimate(icp.getSummary(), icp.getSamples());
  icp.getFitnessScore();
}

} // namespace

extern "C" int
LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/)
{
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  return 0;
}

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  const fuzz::RegistrationInput input = fuzz::registrationInputOf(data, size);
  registerByCore(input);
  registerByClass(input);
  return 0;
}
