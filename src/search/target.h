/** \file
 * \brief The target of preset `exact`: it finds the matches of moved points.
 */
#pragma once

#include "search/neighbor_cache.h"

#include <bayesian_icp/correspondence.h>
#include <bayesian_icp/kd_tree.h>
#include <bayesian_icp/options.h>

#include <vector>

namespace bayesian_icp {

/** \brief The target point with which a moved source point is compared. */
struct TargetMatch {
  /** Column of the moved points. */
  std::size_t column;
  /** Target frame [m]. */
  Eigen::Vector3f point;
  /** Unit normal at that point; zero if the target has none. */
  Eigen::Vector3f normal;
  /** C of its neighbourhood; null if the target has none. */
  const Eigen::Matrix3d* covariance = nullptr;
};

/** \brief Interface: finds matches within the gate. */
class Target {
public:
  virtual ~Target() = default;

  /** \brief Match moved source points.
   * \param[in] pose source-to-target pose that moved the points [m, rad]
   * \param[in] indices index in the source of each column of \p moved
   * \param[in] moved 3 x m, target frame [m]
   * \param[in,out] cache of all source points and one thread; it changes the speed,
   *                but not the matches
   * \param[out] matches at most one for each column, in the order of the columns */
  virtual void
  match(const Vector6d& pose,
        const std::vector<std::size_t>& indices,
        const Eigen::Matrix3Xf& moved,
        NeighborCache& cache,
        std::vector<TargetMatch>& matches) const = 0;

  /** \brief Whether several threads may call match() at the same time. */
  virtual bool
  isThreadSafe() const
  {
    return true;
  }
};

/** \brief Exact nearest neighbours in a KdTree, for any number of threads. */
class TreeTarget : public Target {
public:
  /** \param[in] tree must outlive this object
   * \param[in] max_distance gate [m]; infinity means no gate
   * \param[in] normals 3 x (number of the tree's points), unit or zero; may be empty
   * \param[in] covariances one for each of the tree's points; may be empty */
  TreeTarget(const KdTree& tree,
             double max_distance,
             Eigen::Matrix3Xf normals = Eigen::Matrix3Xf(),
             std::vector<Eigen::Matrix3d> covariances = {});

  void
  match(const Vector6d& pose,
        const std::vector<std::size_t>& indices,
        const Eigen::Matrix3Xf& moved,
        NeighborCache& cache,
        std::vector<TargetMatch>& matches) const override;

private:
  const KdTree& tree_;
  float max_squared_distance_;
  Eigen::Matrix3Xf normals_;
  std::vector<Eigen::Matrix3d> covariances_;
};

/** \brief The target with what \p residual needs of it, and its gate. */
TreeTarget
treeTargetFor(const ResidualOptions& residual, const KdTree& tree);

/** \brief Matches of a user's CorrespondenceSearch, without cache and normals. */
class SearchTarget : public Target {
public:
  /** \param[in] search must outlive this object */
  explicit SearchTarget(const CorrespondenceSearch& search) : search_(search) {}

  void
  match(const Vector6d& pose,
        const std::vector<std::size_t>& indices,
        const Eigen::Matrix3Xf& moved,
        NeighborCache& cache,
        std::vector<TargetMatch>& matches) const override;

  bool
  isThreadSafe() const override
  {
    return search_.isThreadSafe();
  }

private:
  const CorrespondenceSearch& search_;
};

/** \brief Unit normals of patches of about 16 neighbouring points. Patches are leaves
 * of a balanced kd-split; the normal is the direction of least variance with an
 * arbitrary sign.
 * \param[in] points 3 x n. The normal of a non-finite point is zero, and so are all
 *            normals if there are fewer than 3 points. */
Eigen::Matrix3Xf
patchNormals(const Eigen::Matrix3Xf& points);

/** \brief C of Residual::DistributionToDistribution for each point, from the same
 * patches: all points of a patch have the same. I / 2, as if a patch were a ball, where
 * there is no patch.
 * \param[in] points 3 x n [m] */
std::vector<Eigen::Matrix3d>
patchCovariances(const Eigen::Matrix3Xf& points,
                 CovarianceRegularization regularization);

} // namespace bayesian_icp
