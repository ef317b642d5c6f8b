// Samples the posterior of a pose with a correspondence search of one's own.
#include <bayesian_icp/pipeline.h>

#include <cmath>
#include <iostream>

namespace {

// The target is searched point by point.
class ExhaustiveSearch : public bayesian_icp::CorrespondenceSearch {
public:
  explicit ExhaustiveSearch(const Eigen::Matrix3Xd& target) : target_(target) {}

  void
  find(const bayesian_icp::Vector6d&,
       const std::vector<std::size_t>&,
       const Eigen::Matrix3Xd& moved_points,
       bayesian_icp::Correspondences& correspondences) const override
  {
    correspondences.clear();
    for (Eigen::Index i = 0; i < moved_points.cols(); ++i) {
      Eigen::Index nearest = 0;
      (target_.colwise() - moved_points.col(i))
          .colwise()
          .squaredNorm()
          .minCoeff(&nearest);
      correspondences.push_back({static_cast<std::size_t>(i), target_.col(nearest)});
    }
  }

  bool
  isThreadSafe() const override
  {
    return true;
  }

private:
  Eigen::Matrix3Xd target_;
};

Eigen::Matrix3Xd
surface()
{
  const int side = 13;
  Eigen::Matrix3Xd points(3, side * side);
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      const double x = 0.15 * (i - side / 2);
      const double y = 0.15 * (j - side / 2);
      points.col(i * side + j) << x, y, 0.3 * std::sin(2.0 * x) * std::cos(3.0 * y);
    }
  return points;
}

} // namespace

int
main()
{
  bayesian_icp::Vector6d truth;
  truth << 0.01, -0.02, 0.015, 0.004, 0.005, 0.008;
  const Eigen::Matrix3Xd target = surface();
  const Eigen::Matrix3d R = bayesian_icp::rotationOf(truth);
  const Eigen::Matrix3Xd source =
      R.transpose() * (target.colwise() - truth.head<3>()).eval();

  bayesian_icp::Options options;
  options.preset = bayesian_icp::Preset::Paper; // a search of its own
  options.chains.num_draws = 80;
  options.paper.batch_size = 80;
  const bayesian_icp::PosteriorEstimate estimate = bayesian_icp::estimatePosterior(
      source, ExhaustiveSearch(target), bayesian_icp::Vector6d::Zero(), options);

  const bayesian_icp::Summary& summary = estimate.summary;
  std::cout << summary.message << "\nmean " << summary.mean.transpose() << '\n';
  const Eigen::RowVector3d mean = estimate.samples.leftCols<3>().colwise().mean();
  const bool is_good = estimate.samples.rows() == options.chains.num_draws &&
                       estimate.samples.allFinite() &&
                       summary.mean.head<3>().isApprox(mean.transpose(), 1e-9) &&
                       (summary.status == bayesian_icp::Status::Ok ||
                        summary.status == bayesian_icp::Status::NotMixed);
  return is_good ? 0 : 1;
}
