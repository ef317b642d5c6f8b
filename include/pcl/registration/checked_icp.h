/** \file
 * \brief What the registration classes of this library share: points and guesses that
 * PCL's ICP would abort on are dealt with, and its search is there to be asked.
 */
#pragma once

#include <pcl/registration/icp.h>
#include <pcl/registration/impl/aligned_icp.hpp>
#include <pcl/registration/impl/bayesian_icp_search.hpp>
#include <pcl/registration/impl/seeded_kd_tree.hpp>

#include <limits>
#include <memory>

namespace pcl {
namespace bayesian_icp_detail {

/** ICP of those points that are finite and selected by indices. */
template <typename PointSource, typename PointTarget, typename Scalar>
class CheckedIterativeClosestPoint
: public AlignedIterativeClosestPoint<PointSource, PointTarget, Scalar> {
public:
  using Base = IterativeClosestPoint<PointSource, PointTarget, Scalar>;
  using Matrix4 = typename Base::Matrix4;
  using PointCloudSource = typename Base::PointCloudSource;
  using PointCloudSourcePtr = typename Base::PointCloudSourcePtr;
  using PointCloudSourceConstPtr = typename Base::PointCloudSourceConstPtr;
  using PointCloudTarget = typename Base::PointCloudTarget;
  using PointCloudTargetPtr = typename Base::PointCloudTargetPtr;
  using PointCloudTargetConstPtr = typename Base::PointCloudTargetConstPtr;

  using Base::convergence_criteria_; // public in PCL's class, too
  using Base::getClassName;
  using Base::getFitnessScore;

  CheckedIterativeClosestPoint() { tree_ = own_tree_; }

  /** \brief Set the cloud to register to. Points further out than 1e18 m, on which
   * PCL's search tree aborts, are left out: the target is then a copy in which they are
   * NaN.
   */
  void
  setInputTarget(const PointCloudTargetConstPtr& cloud) override;

  /** \brief Mean squared distance [m^2] of the transformed source to the target, as
   * PCL's, leaving out non-finite points (PCL 1.13 aborts on them, also where it is
   * called through a pointer to PCL's class).
   * \param[in] max_range largest squared distance that counts [m^2]
   * \return the largest double if no point is in range */
  double
  getFitnessScore(double max_range = std::numeric_limits<double>::max());

protected:
  using Base::converged_;
  using Base::corr_dist_threshold_;
  using Base::correspondence_estimation_;
  using Base::correspondence_rejectors_;
  using Base::correspondences_;
  using Base::final_transformation_;
  using Base::force_no_recompute_;
  using Base::indices_;
  using Base::input_;
  using Base::min_number_correspondences_;
  using Base::nr_iterations_;
  using Base::source_has_normals_;
  using Base::target_;
  using Base::target_has_normals_;
  using Base::transformation_estimation_;
  using Base::transformCloud;
  using Base::tree_;
  using Base::tree_reciprocal_;
  using Base::use_reciprocal_correspondence_;

  /** The state of convergence_criteria_ [see pcl::registration]. */
  using State = registration::DefaultConvergenceCriteria<Scalar>;

  /** Registers the usable points, and moves the whole source to where they went. */
  void
  computeTransformation(PointCloudSource& output, const Matrix4& guess) override;

  /** Forget the last registration. */
  virtual void
  forgetResult() = 0;

  /** Register \p source, the usable points, which is input_ at the time of the call:
   * set final_transformation_, converged_, correspondences_ and the like.
   * \return whether \p output is now the moved source */
  virtual bool
  registerUsable(const PointCloudSourceConstPtr& source,
                 PointCloudSource& output,
                 const Matrix4& guess) = 0;

  /** Take note of clouds or a guess that cannot be registered; it has been reported. */
  virtual void
  keepFailure(bool is_guess_finite, const char* reason) = 0;

  bool
  hasDefaultEstimation() const;

  /** A search among the pairs that the estimation and the rejectors would find for
   * points of \p source. */
  std::unique_ptr<PairSearch<PointTarget>>
  makeCorrespondenceSearch(const PointCloudSourceConstPtr& source);

  /** The transformation next to \p to that the transformation estimation allows: a
   * user's own may know some motions only (2-D, translation), so it is asked for the
   * one that brings \p source from \p from to \p to. */
  Matrix4
  asEstimationAllows(const PointCloudSource& source,
                     const Matrix4& from,
                     const Matrix4& to);

  /** The search tree of the target, unless the user installs another one. */
  const shared_ptr<SeededKdTree<PointTarget>> own_tree_ =
      pcl::make_shared<SeededKdTree<PointTarget>>();

private:
  bool
  targetIsUsable() const;

  void
  failWithoutCorrespondences(PointCloudSource& output, const Matrix4& guess);
};

} // namespace bayesian_icp_detail
} // namespace pcl

#include <pcl/registration/impl/checked_icp.hpp>

/** Calls X(point type, scalar) for every instantiation that the library holds. */
#define PCL_BAYESIAN_ICP_FOR_POINT_TYPES(X, Scalar)                                    \
  X(pcl::PointXYZ, Scalar)                                                             \
  X(pcl::PointXYZI, Scalar)                                                            \
  X(pcl::PointXYZRGB, Scalar)                                                          \
  X(pcl::PointXYZRGBA, Scalar)                                                         \
  X(pcl::PointNormal, Scalar)                                                          \
  X(pcl::PointXYZRGBNormal, Scalar)                                                    \
  X(pcl::PointXYZINormal, Scalar)

#if !defined(PCL_NO_PRECOMPILE) && !defined(PCL_REGISTRATION_CHECKED_ICP_CPP_)
#define PCL_BAYESIAN_ICP_DECLARE(PointT, Scalar)                                       \
  extern template class pcl::bayesian_icp_detail::                                     \
      CheckedIterativeClosestPoint<PointT, PointT, Scalar>;
PCL_BAYESIAN_ICP_FOR_POINT_TYPES(PCL_BAYESIAN_ICP_DECLARE, float)
PCL_BAYESIAN_ICP_FOR_POINT_TYPES(PCL_BAYESIAN_ICP_DECLARE, double)
#undef PCL_BAYESIAN_ICP_DECLARE
#endif
