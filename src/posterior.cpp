#include <bayesian_icp/posterior.h>

namespace bayesian_icp {

CorrespondenceSearch::~CorrespondenceSearch() = default;

PosteriorGradient::PosteriorGradient(const Eigen::Matrix3Xd& source_points,
                                     const CorrespondenceSearch& search,
                                     const Prior& prior,
                                     double weight,
                                     const MiniBatches& mini_batches)
: source_points_(source_points)
, search_(search)
, prior_(prior)
, weight_(weight)
, mini_batches_(mini_batches)
{}

EnergyGradient
PosteriorGradient::operator()(const Vector6d& pose, Random& random)
{
  const auto& batch = mini_batches_.next(random);
  batch_points_.resize(3, static_cast<Eigen::Index>(batch.size()));
  for (std::size_t i = 0; i < batch.size(); ++i)
    batch_points_.col(static_cast<Eigen::Index>(i)) =
        source_points_.col(static_cast<Eigen::Index>(batch[i]));
  movePoints(pose, batch_points_, moved_points_);
  search_.find(pose, batch, moved_points_, correspondences_);

  EnergyGradient gradient;
  gradient.mini_batch_mean =
      meanGradient(pose, batch_points_, moved_points_, correspondences_);
  gradient.energy = weight_ * gradient.mini_batch_mean + prior_.energyGradient(pose);
  return gradient;
}

} // namespace bayesian_icp
