// Uses the class as a program does that had pcl::IterativeClosestPoint before, or
// prints the report (--report, --layout): what has to be the same on both sides of the
// library's border, the layout of what is passed over it, and results. Whoever compiles
// it, and how, the text is one.
#include "report.h"
#include "surface.h"

#include <bayesian_icp/draws.h>
#include <bayesian_icp/exports.h>
#include <bayesian_icp/tree_search.h>

#include <pcl/registration/bayesian_icp.h>
#include <pcl/registration/stochastic_gradient_icp.h>
#include <pcl/point_types.h>

#include <Eigen/Cholesky>

#include <cstddef>
#include <memory>
#include <string>

using namespace bayesian_icp;
using Registration = pcl::BayesianIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ>;
using Precise =
    pcl::BayesianIterativeClosestPoint<pcl::PointNormal, pcl::PointNormal, double>;
using Descent =
    pcl::StochasticGradientDescentIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ>;

bool
registersOwnPointType();

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
  const auto status = registration.getSummary().status;
  return expect(registration.getMean().head<3>().isApprox(mean, 1e-9), "the mean") &&
         expect(reported.topLeftCorner<3, 3>().isApprox(covariance, 1e-9),
                "the covariance") &&
         expect(on_se3.llt().info() == Eigen::Success, "a covariance on SE(3)") &&
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

// A size and an alignment, or an offset.
#define SIZE(type) printNumbers(#type ": size, alignment", sizeof(type), alignof(type))
#define OFFSET(type, member) printNumbers(#type "." #member, offsetof(type, member))

template <typename... Numbers>
static void
printNumbers(const char* what, Numbers... numbers)
{
  std::cout << what;
  for (const std::size_t number : {numbers...})
    std::cout << ' ' << number;
  std::cout << '\n';
}

static void
reportOptionsLayout()
{
  SIZE(Automatic<int>);
  SIZE(Automatic<Vector6d>);
  SIZE(LikelihoodScale);
  SIZE(PriorOptions);
  SIZE(SgldOptions);
  SIZE(ChainOptions);
  SIZE(ResidualOptions);
  SIZE(PaperOptions);
  SIZE(ExactOptions);
  SIZE(CalibratedOptions);
  SIZE(Options);
  SIZE(StochasticGradientIcpOptions);
  SIZE(ExportOptions);
  OFFSET(Options, preset);
  OFFSET(Options, prior);
  OFFSET(Options, chains);
  OFFSET(Options, paper);
  OFFSET(Options, exact);
  OFFSET(Options, calibrated);
}

static void
reportResultsLayout()
{
  SIZE(Progress);
  SIZE(Chain);
  SIZE(CoordinateSummary);
  SIZE(Mode);
  SIZE(DataDirection);
  SIZE(DataReport);
  SIZE(Summary);
  SIZE(PosteriorEstimate);
  SIZE(Correspondence);
  SIZE(StochasticGradientIcpResult);
  SIZE(PoseEstimate);
  OFFSET(Summary, status);
  OFFSET(Summary, message);
  OFFSET(Summary, mean);
  OFFSET(Summary, coordinates);
  OFFSET(Summary, modes);
  OFFSET(Summary, data);
  OFFSET(Summary, covariances);
  OFFSET(PosteriorEstimate, chains);
  OFFSET(PosteriorEstimate, samples);
}

static void
reportClassesLayout()
{
  SIZE(Vector6d);
  SIZE(Matrix6d);
  SIZE(PoseMatrix);
  SIZE(Eigen::Isometry3d);
  SIZE(Random);
  SIZE(Prior);
  SIZE(KdTree);
  SIZE(TreeSearch);
  SIZE(CorrespondenceSearch);
  SIZE(Registration);
  SIZE(Precise);
  SIZE(Descent);
}

// Options are filled here and read there, the last field and a text on its way back.
static void
reportComplaints()
{
  Options options;
  options.calibrated.num_mode_points = 7;
  std::cout << "complaint: " << options.validate() << '\n';
  options = Options();
  options.preset = Preset::Exact;
  options.exact.initial_spread = Vector6d(-0.25 * Vector6d::Unit(5));
  std::cout << "complaint: " << options.validate() << '\n';
}

static void
reportPointXYZ()
{
  const auto source = scan<pcl::PointXYZ>(1, 300);
  const auto target = scan<pcl::PointXYZ>(2, 1200);
  Registration registration;
  registration.setInputSource(source);
  registration.setInputTarget(target);
  pcl::PointCloud<pcl::PointXYZ> output;
  for (const auto preset : {Preset::Calibrated, Preset::Exact, Preset::Paper}) {
    registration.setOptions(reportOptions(preset));
    registration.align(output);
    print("icp", registration.getFinalTransformation());
    printPosterior(toString(preset), registration);
  }
}

// What is made here is deleted by a destructor of the library's.
static void
reportDeletion()
{
  using Icp = pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ>;
  const std::unique_ptr<Icp> icps[] = {std::unique_ptr<Icp>(new Registration),
                                       std::unique_ptr<Icp>(new Descent)};
  for (const auto& icp : icps)
    std::cout << "on the heap: " << icp->getClassName() << '\n';
}

static void
reportLayout()
{
  reportOptionsLayout();
  reportResultsLayout();
  reportClassesLayout();
}

static void
reportResults()
{
  reportComplaints();
  reportDeletion();
  reportPointXYZ();
  reportOwnPointType();
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
