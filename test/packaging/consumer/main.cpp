// Uses the class as a program does that had pcl::IterativeClosestPoint before, or
// prints the report (--report, --layout).
#include "report.h"
#include "surface.h"

#include <pcl/registration/bayesian_icp.h>
#include <pcl/point_types.h>

#include <Eigen/Eigenvalues>

#include <memory>
#include <string>

bool
registersOwnPointType();

using Registration = pcl::BayesianIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ>;

// Whether what crossed the library's border is whole: mean and covariance are the
// draws'.
static bool
describesPosterior(const Registration& registration)
{
  const Registration::Samples samples = registration.getSamples();
  if (!expect(samples.rows() == 2000 && samples.allFinite(), "2000 finite draws"))
    return false;
  const Eigen::Vector3d mean = samples.leftCols<3>().colwise().mean();
  const Eigen::MatrixXd centred = samples.leftCols<3>().rowwise() - mean.transpose();
  const Eigen::Matrix3d covariance = centred.transpose() * centred / 1999.0;
  const auto reported = registration.getCovariance();
  const auto on_se3 =
      registration.getCovariance(bayesian_icp::CovarianceConvention::LeftSE3);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(on_se3);
  const auto status = registration.getSummary().status;
  return expect(registration.getMean().head<3>().isApprox(mean, 1e-9), "the mean") &&
         expect(reported.topLeftCorner<3, 3>().isApprox(covariance, 1e-9),
                "the covariance") &&
         expect(solver.eigenvalues().minCoeff() > 0.0, "a covariance on SE(3)") &&
         expect(status == bayesian_icp::Status::Ok ||
                    status == bayesian_icp::Status::NotMixed,
                "a status of a finished run");
}

static bool
replacesIterativeClosestPoint()
{
  const ScanPair<pcl::PointXYZ> scans;
  auto registration = std::make_shared<Registration>();
  // The scans have no noise, in which the default preset measures.
  registration->setPreset(bayesian_icp::Preset::Paper);
  registration->setSeed(7);
  registration->setNumberOfThreads(2);

  // Through the base class: the layouts on both sides of the library must agree.
  pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ>::Ptr icp = registration;
  icp->setInputSource(scans.source);
  icp->setInputTarget(scans.target);
  icp->setMaximumIterations(50);
  pcl::PointCloud<pcl::PointXYZ> output;
  icp->align(output);

  const Eigen::Matrix4f truth = scans.T_target_source.matrix();
  return expect(icp->hasConverged(), "converged") &&
         expect(output.size() == scans.source->size(),
                "output as large as the source") &&
         expect(icp->getFinalTransformation().isApprox(truth, 1e-4f),
                "the true pose") &&
         describesPosterior(*registration);
}

int
main(int argc, char** argv)
{
  const std::string option = argc == 2 ? argv[1] : "";
  if (option == "--layout")
    reportLayout();
  else if (option == "--report")
    reportResults();
  else
    return registersOwnPointType() && replacesIterativeClosestPoint() ? 0 : 1;
  return 0;
}
