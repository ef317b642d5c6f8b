/** \file
 * \brief What the registration classes of this library share: points and guesses that
 * PCL's ICP would abort on are dealt with, and its search is there to be asked.
 */
#pragma once

#include <pcl/common/io.h>
#include <pcl/common/point_tests.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/impl/bayesian_icp_search.hpp>
#include <pcl/registration/impl/seeded_kd_tree.hpp>
#include <pcl/registration/transformation_estimation_svd.h>

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>
#include <new>
#include <numeric>
#include <string>
#include <type_traits>
#include <typeinfo>
#include <utility>
#include <vector>

namespace pcl {
namespace bayesian_icp_detail {

/** Puts another value into a variable for the lifetime of this object. */
template <typename T>
class Substitution {
public:
  Substitution(T& variable, T value) : variable_(variable), original_(std::move(value))
  {
    std::swap(variable_, original_);
  }
  ~Substitution() { std::swap(variable_, original_); }
  Substitution(const Substitution&) = delete;
  Substitution&
  operator=(const Substitution&) = delete;

private:
  T& variable_;
  T original_;
};

/** Stands where a search tree of PCL should hold a tree of FLANN and holds null. */
template <typename PointT>
struct StandIn : KdTreeFLANN<PointT> {};

/** Give a search tree that was made without a tree of FLANN inside, as KdTreeNanoflann
 * of PCL 1.15.1 is, a StandIn: PCL's functions that are not virtual dereference what is
 * inside. A tree that leaves everything to the one inside has a usable one then.
 * \return whether it has a StandIn: it may find points by itself */
template <typename PointT>
bool
fillHollow(search::KdTree<PointT>& tree)
{
  struct Opened : search::KdTree<PointT> {
    static auto&
    insideOf(search::KdTree<PointT>& closed)
    {
      return (closed.*(&Opened::tree_));
    }
  };
  auto& inside = Opened::insideOf(tree);
  if (!inside)
    inside = pcl::make_shared<StandIn<PointT>>();
  const auto& found = *inside;
  return (typeid(found) == typeid(StandIn<PointT>));
}

/** Whether a search tree answers as PCL's own, with PCL's own idea of a point. What is
 * inside is looked at where the type says that there is something. */
template <typename PointT>
bool
isDefaultTree(const search::KdTree<PointT>& tree)
{
  return ((typeid(tree) == typeid(search::KdTree<PointT>) ||
           typeid(tree) == typeid(SeededKdTree<PointT>)) &&
          isDefault(*tree.getPointRepresentation()));
}

/** Whether a transformation is a rotation and a translation, to the accuracy of float,
 * in homogeneous coordinates. */
inline bool
isRigid(const Eigen::Matrix4d& transformation)
{
  constexpr double tolerance = 1e-3;
  const Eigen::Matrix3d R = transformation.topLeftCorner<3, 3>();
  return ((R.transpose() * R - Eigen::Matrix3d::Identity()).norm() < tolerance &&
          R.determinant() > 0.0 &&
          (transformation.row(3) - Eigen::RowVector4d::Unit(3)).norm() < tolerance);
}

/** Whether \p indices is 0, 1, ..., num_points - 1. */
inline bool
isWholeCloud(const Indices& indices, std::size_t num_points)
{
  if (indices.size() != num_points)
    return (false);
  for (std::size_t i = 0; i < num_points; ++i)
    if (indices[i] != static_cast<index_t>(i))
      return (false);
  return (true);
}

/** Whether a cloud of \p num_points has all points of \p indices. */
inline bool
areWithin(const Indices& indices, std::size_t num_points)
{
  return (std::all_of(indices.begin(), indices.end(), [num_points](index_t index) {
    return (static_cast<std::size_t>(index) < num_points); // nor is it negative
  }));
}

/** Those of \p indices whose point can be searched for where it is and where \p guess
 * moves it. */
template <typename PointT>
IndicesPtr
usablePoints(const PointCloud<PointT>& cloud,
             const Indices& indices,
             const Eigen::Matrix4f& guess)
{
  const Eigen::Matrix3f R = guess.topLeftCorner<3, 3>();
  const Eigen::Vector3f translation = guess.topRightCorner<3, 1>();
  const IndicesPtr usable(new Indices);
  usable->reserve(indices.size());
  for (const auto index : indices) {
    const Eigen::Vector3f position = cloud[index].getVector3fMap();
    const Eigen::Vector3f moved = R * position + translation;
    if (canBeQueried(position) && canBeQueried(moved))
      usable->push_back(index);
  }
  return (usable);
}

/** ICP of those points that are finite and selected by indices.
 *
 * Its new and delete are Eigen's aligned ones in every standard of C++. Those of PCL's
 * classes are so in C++14 only: an object that a program in C++14 has made would be
 * deleted by the library, which is C++17, in another way, or not even be linked. */
template <typename PointSource, typename PointTarget, typename Scalar>
class CheckedIterativeClosestPoint
: public IterativeClosestPoint<PointSource, PointTarget, Scalar> {
public:
  using Base = IterativeClosestPoint<PointSource, PointTarget, Scalar>;
  using Matrix4 = typename Base::Matrix4;
  using PointCloudSource = typename Base::PointCloudSource;
  using PointCloudSourcePtr = typename Base::PointCloudSourcePtr;
  using PointCloudSourceConstPtr = typename Base::PointCloudSourceConstPtr;
  using PointCloudTarget = typename Base::PointCloudTarget;
  using PointCloudTargetPtr = typename Base::PointCloudTargetPtr;
  using PointCloudTargetConstPtr = typename Base::PointCloudTargetConstPtr;
  using KdTreePtr = typename Base::KdTreePtr;
  using KdTreeReciprocalPtr = typename Base::KdTreeReciprocalPtr;
  using PointRepresentationConstPtr = typename Base::PointRepresentationConstPtr;

  using Base::convergence_criteria_; // public in PCL's class, too
  using Base::getClassName;
  using Base::getFitnessScore;

  CheckedIterativeClosestPoint()
  {
    tree_ = own_tree_;
    correspondence_estimation_ = own_estimation_;
  }

  static void*
  operator new(std::size_t size)
  {
    return (Eigen::internal::aligned_malloc(size));
  }

  static void*
  operator new[](std::size_t size)
  {
    return (Eigen::internal::aligned_malloc(size));
  }

  static void*
  operator new(std::size_t size, const std::nothrow_t&) noexcept
  {
    try {
      return (Eigen::internal::aligned_malloc(size));
    }
    catch (const std::bad_alloc&) {
      return (nullptr);
    }
  }

  static void*
  operator new(std::size_t /* size */, void* place) noexcept
  {
    return (place);
  }

  static void
  operator delete(void* object) noexcept
  {
    Eigen::internal::aligned_free(object);
  }

  static void
  operator delete[](void* objects) noexcept
  {
    Eigen::internal::aligned_free(objects);
  }

  static void
  operator delete(void* object, const std::nothrow_t&) noexcept
  {
    Eigen::internal::aligned_free(object);
  }

  static void
  operator delete(void* /* object */, void* /* place */) noexcept
  {}

  /** \brief Set the cloud to register. A null pointer or an empty cloud is refused,
   * with a message. PCL keeps the cloud before it; align() fails until a cloud is set.
   */
  void
  setInputSource(const PointCloudSourceConstPtr& cloud) override
  {
    is_source_refused_ = !cloud || cloud->empty();
    if (!refuse(!cloud, "setInputSource", "the cloud is a null pointer"))
      Base::setInputSource(cloud);
  }

  /** \brief Set the cloud to register to. Refused as by setInputSource(). Points
   * further out than 1e18 m, on which PCL's search tree aborts, are left out: the
   * target is then a copy in which they are NaN.
   */
  void
  setInputTarget(const PointCloudTargetConstPtr& cloud) override
  {
    is_target_refused_ = !cloud || cloud->empty();
    if (refuse(!cloud, "setInputTarget", "the cloud is a null pointer"))
      return;
    const auto is_too_far = [](const PointTarget& point) {
      return (isXYZFinite(point) && !canBeQueried(point.getVector3fMap()));
    };
    if (std::none_of(cloud->begin(), cloud->end(), is_too_far)) {
      Base::setInputTarget(cloud);
      return;
    }
    const PointCloudTargetPtr usable(new PointCloudTarget(*cloud));
    for (auto& point : *usable)
      if (is_too_far(point))
        point.getVector3fMap().setConstant(std::numeric_limits<float>::quiet_NaN());
    usable->is_dense = false;
    Base::setInputTarget(usable);
  }

  /** \brief align() with the identity as guess. */
  void
  align(PointCloudSource& output)
  {
    align(output, Matrix4::Identity());
  }

  /** \brief Register, as PCL's. Indices outside their cloud, and a source or target
   * that was refused, are an invalid input. A pointer to PCL's class calls PCL's
   * align(), which reads the points of all indices before they can be checked, cuts an
   * \p output that is the source to these points, and keeps the last result if the
   * search tree throws as it gets the target.
   * \param[out] output the source, moved; empty if the source was refused. It may be
   *             the source itself
   * \param[in] guess initial source-to-target transformation */
  void
  align(PointCloudSource& output, const Matrix4& guess)
  {
    const std::string complaint = complaintAboutInput();
    if (!complaint.empty()) {
      fail(output, guess, false, complaint);
      return;
    }
    forgetResult(); // the user's search tree may throw before computeTransformation()
    converged_ = false;
    if (&output != input_.get()) {
      Base::align(output, guess);
      return;
    }
    PointCloudSource moved; // PCL would cut the source to the indices first
    Base::align(moved, guess);
    output = std::move(moved);
  }

  /** \brief Set the search tree of the target, as PCL's. Refused, with a message, are a
   * null pointer, and a tree that cannot be told of the point representation that was
   * set: one without PCL's tree inside. The tree that was there is kept then.
   * \param[in] tree where points are searched
   * \param[in] force_no_recompute whether it is ready, and not given the target */
  void
  setSearchMethodTarget(const KdTreePtr& tree, bool force_no_recompute = false)
  {
    if (refuse(!tree, "setSearchMethodTarget", "the search tree is a null pointer"))
      return;
    // A ready tree may be in use by others, and PCL leaves it as it is.
    if (!force_no_recompute &&
        refuse(fillHollow(*tree) && point_representation_,
               "setSearchMethodTarget",
               "the search tree cannot be given the point representation"))
      return;
    Base::setSearchMethodTarget(tree, force_no_recompute);
  }

  /** \brief Set the search tree of the source, for reciprocal pairs, as PCL's; a null
   * pointer is refused.
   * \param[in] tree where points are searched
   * \param[in] force_no_recompute whether it is ready, and not given the source */
  void
  setSearchMethodSource(const KdTreeReciprocalPtr& tree,
                        bool force_no_recompute = false)
  {
    if (refuse(!tree, "setSearchMethodSource", "the search tree is a null pointer"))
      return;
    if (!force_no_recompute)
      fillHollow(*tree);
    Base::setSearchMethodSource(tree, force_no_recompute);
  }

  /** \brief Set how points are compared, as PCL's. Refused, with a message, if the
   * search tree of the target cannot be told [see setSearchMethodTarget]. */
  void
  setPointRepresentation(const PointRepresentationConstPtr& representation)
  {
    if (representation && !force_no_recompute_ &&
        refuse(fillHollow(*tree_),
               "setPointRepresentation",
               "the search tree cannot be given the point representation"))
      return;
    point_representation_ = representation;
    Base::setPointRepresentation(representation);
  }

  /** \brief Mean squared distance [m^2] of the transformed source to the target, as
   * PCL's, leaving out non-finite points (PCL 1.13 aborts on them, also where it is
   * called through a pointer to PCL's class).
   * \param[in] max_range largest squared distance that counts [m^2]
   * \return the largest double if no point is in range, or a cloud is missing or was
   *         refused */
  double
  getFitnessScore(double max_range = std::numeric_limits<double>::max())
  {
    if (is_source_refused_ || is_target_refused_ || !input_ || !target_)
      return (std::numeric_limits<double>::max());
    PointCloudSource moved;
    transformPointCloud(*input_, moved, final_transformation_);
    Indices index(1);
    std::vector<float> squared_distance(1);
    double sum = 0.0;
    std::size_t num_in_range = 0;
    PointTarget query;
    for (const auto& point : moved) {
      if (!canBeQueried(point.getVector3fMap()))
        continue;
      copyPoint(point, query);
      if (tree_->nearestKSearch(query, 1, index, squared_distance) > 0 &&
          squared_distance[0] <= max_range) {
        sum += squared_distance[0];
        ++num_in_range;
      }
    }
    return (num_in_range > 0 ? sum / static_cast<double>(num_in_range)
                             : std::numeric_limits<double>::max());
  }

protected:
  using Base::converged_;
  using Base::corr_dist_threshold_;
  using Base::correspondence_estimation_;
  using Base::correspondence_rejectors_;
  using Base::correspondences_;
  using Base::fake_indices_;
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

  /** Registers the usable points, and moves the whole source. */
  void
  computeTransformation(PointCloudSource& output, const Matrix4& guess) override
  {
    const std::string complaint = complaintAboutInput();
    if (!complaint.empty()) {
      fail(output, guess, false, complaint);
      return;
    }
    forgetResult();
    const Eigen::Matrix4f float_guess = guess.template cast<float>();
    if (!float_guess.allFinite()) {
      fail(output, guess, false, "the initial guess is not finite");
      return;
    }
    const IndicesPtr usable = usablePoints(*input_, selectedPoints(), float_guess);
    if (!anyOfSearched([](index_t) { return (true); }) ||
        usable->size() < static_cast<std::size_t>(min_number_correspondences_)) {
      fail(output,
           guess,
           true,
           "fewer points with finite coordinates below 1e18 m than the registration "
           "needs");
      return;
    }
    try {
      const bool is_whole = isWholeCloud(*usable, input_->size());
      const SourceIndices<typename Base::CorrespondenceEstimation> searched(
          *correspondence_estimation_, is_whole ? IndicesPtr() : usable);
      registerUsable(usable, guess);
    }
    catch (...) { // of a callback, a plug-in or the memory
      forgetResult();
      correspondences_->clear();
      converged_ = false;
      throw;
    }
    output = *input_;
    transformCloud(*input_, output, final_transformation_);
  }

  /** Forget the last registration. */
  virtual void
  forgetResult() = 0;

  /** Register the \p usable points of input_: set final_transformation_, converged_,
   * correspondences_ and the like. The correspondence estimation searches for them
   * only. */
  virtual void
  registerUsable(const IndicesConstPtr& usable, const Matrix4& guess) = 0;

  /** Take note of an input that is not valid, or has too few points; it has been
   * reported. */
  virtual void
  keepFailure(bool is_input_valid, const char* reason) = 0;

  bool
  hasDefaultEstimation() const
  {
    const auto& estimation = *correspondence_estimation_;
    if (correspondence_estimation_ != own_estimation_ &&
        typeid(estimation) != typeid(registration::CorrespondenceEstimation<PointSource,
                                                                            PointTarget,
                                                                            Scalar>))
      return (false);
    return (isDefaultTree(*tree_) &&
            (!use_reciprocal_correspondence_ || isDefaultTree(*tree_reciprocal_)));
  }

  /** What pcl::IterativeClosestPoint does before its first iteration. */
  void
  giveTargetToPlugins()
  {
    this->determineRequiredBlobData();
    PCLPointCloud2::Ptr target_blob(new PCLPointCloud2);
    if (this->need_target_blob_)
      toPCLPointCloud2(*target_, *target_blob);
    correspondence_estimation_->setInputTarget(target_);
    if (correspondence_estimation_->requiresTargetNormals())
      correspondence_estimation_->setTargetNormals(target_blob);
    for (const auto& rejector : correspondence_rejectors_) {
      if (rejector->requiresTargetPoints())
        rejector->setTargetPoints(target_blob);
      if (rejector->requiresTargetNormals() && target_has_normals_)
        rejector->setTargetNormals(target_blob);
    }
    // The default estimation does so when it is first asked.
    if (!force_no_recompute_ && hasDefaultEstimation())
      tree_->setInputCloud(target_, correspondence_estimation_->getIndicesTarget());
  }

  /** A search among the pairs that the estimation and the rejectors would find for
   * \p usable points of the source within \p max_distance [m]. */
  std::unique_ptr<PairSearch<PointTarget>>
  makeCorrespondenceSearch(const IndicesConstPtr& usable, double max_distance)
  {
    std::unique_ptr<KdTreeSearch<PointSource, PointTarget>> default_search;
    if (hasDefaultEstimation())
      default_search.reset(new KdTreeSearch<PointSource, PointTarget>(
          tree_,
          target_,
          max_distance,
          usable,
          use_reciprocal_correspondence_ ? input_ : PointCloudSourceConstPtr()));
    if (default_search && correspondence_rejectors_.empty())
      return default_search;

    typename PluginSearch<PointSource, PointTarget, Scalar>::Plugins plugins;
    plugins.default_search = std::move(default_search);
    plugins.estimation = correspondence_estimation_;
    plugins.rejectors = correspondence_rejectors_;
    plugins.max_distance = max_distance;
    plugins.is_reciprocal = use_reciprocal_correspondence_;
    plugins.source_has_normals = source_has_normals_;
    plugins.needs_blob = this->need_source_blob_;
    plugins.transform = [this](const PointCloudSource& in,
                               PointCloudSource& out,
                               const Matrix4& T) { transformCloud(in, out, T); };
    return (std::unique_ptr<PairSearch<PointTarget>>(
        new PluginSearch<PointSource, PointTarget, Scalar>(
            plugins, input_, usable, target_)));
  }

  bool
  hasReadyTree() const
  {
    return (force_no_recompute_ && tree_->getInputCloud());
  }

  /** The cloud of the target points that the search tree finds. */
  const PointCloudTarget&
  searchedCloud() const
  {
    return (hasReadyTree() ? *tree_->getInputCloud() : *target_);
  }

  /** Calls \p visit for the index of each of its finite points that the search tree
   * finds, until it returns true.
   * \return whether it did */
  template <typename Visit>
  bool
  anyOfSearched(const Visit& visit) const
  {
    if (force_no_recompute_ && !hasReadyTree() && isDefaultTree(*tree_))
      return (false);
    const PointCloudTarget& cloud = searchedCloud();
    const IndicesConstPtr selected =
        hasReadyTree()
            ? tree_->getIndices()
            : IndicesConstPtr(correspondence_estimation_->getIndicesTarget());
    const auto isFiniteAndVisited = [&](index_t index) {
      return (isXYZFinite(cloud[static_cast<std::size_t>(index)]) && visit(index));
    };
    if (selected)
      return (std::any_of(selected->begin(), selected->end(), isFiniteAndVisited));
    for (std::size_t i = 0; i < cloud.size(); ++i)
      if (isFiniteAndVisited(static_cast<index_t>(i)))
        return (true);
    return (false);
  }

  /** The transformation next to \p to that the transformation estimation allows: a
   * user's own may know some motions only (2-D, translation), so it is asked for the
   * one that brings \p usable points from \p from to \p to, until none moves, because
   * its steps may be linearised. Normals do not matter, and may be unset: every point
   * gets one along an axis. Not finite, with a warning, if it knows no motion. */
  Matrix4
  asEstimationAllows(const Indices& usable, const Matrix4& from, const Matrix4& to)
  {
    const auto& estimation = *transformation_estimation_;
    if (typeid(estimation) ==
        typeid(registration::
                   TransformationEstimationSVD<PointSource, PointTarget, Scalar>))
      return (to);
    constexpr int max_steps = 20;
    constexpr Scalar negligible = Scalar(1e-6);
    PointCloudSource source;
    copyPointCloud(*input_, usable, source);
    PointCloudSource there = source, here = source;
    transformCloud(source, there, to);
    PointCloudTarget goal;
    copyPointCloud(there, goal);
    setNormals(goal);
    Matrix4 allowed = from;
    for (int step = 0; step < max_steps; ++step) {
      transformCloud(source, here, allowed);
      setNormals(here);
      Matrix4 motion = Matrix4::Constant(std::numeric_limits<Scalar>::quiet_NaN());
      estimation.estimateRigidTransformation(here, goal, motion);
      allowed = (motion * allowed).eval();
      if (!allowed.allFinite()) {
        PCL_WARN("[pcl::%s::computeTransformation] The transformation estimation knows "
                 "no motion to the pose that was found.\n",
                 getClassName().c_str());
        break;
      }
      if ((motion - Matrix4::Identity()).cwiseAbs().maxCoeff() < negligible)
        break;
    }
    return (allowed);
  }

  /** The search tree of the target, unless the user installs another one. */
  const shared_ptr<SeededKdTree<PointTarget>> own_tree_ =
      pcl::make_shared<SeededKdTree<PointTarget>>();

  /** The correspondence estimation, unless the user installs another one. */
  const shared_ptr<SeededEstimation<PointSource, PointTarget, Scalar>> own_estimation_ =
      pcl::make_shared<SeededEstimation<PointSource, PointTarget, Scalar>>();

private:
  template <typename PointT>
  static std::enable_if_t<traits::has_normal<PointT>::value>
  setNormals(PointCloud<PointT>& cloud)
  {
    int axis = 0;
    for (PointT& point : cloud) {
      point.normal_x = axis == 0 ? 1.0F : 0.0F;
      point.normal_y = axis == 1 ? 1.0F : 0.0F;
      point.normal_z = axis == 2 ? 1.0F : 0.0F;
      axis = (axis + 1) % 3;
    }
  }

  template <typename PointT>
  static std::enable_if_t<!traits::has_normal<PointT>::value>
  setNormals(PointCloud<PointT>&)
  {}

  /** Says why a plug-in is not taken.
   * \return \p is_refused */
  bool
  refuse(bool is_refused, const char* setter, const char* reason) const
  {
    if (is_refused)
      PCL_ERROR(
          "[pcl::%s::%s] Not taken: %s.\n", getClassName().c_str(), setter, reason);
    return (is_refused);
  }

  /** What is wrong with clouds, indices and plug-ins; empty if nothing is. */
  std::string
  complaintAboutInput() const
  {
    if (is_source_refused_)
      return ("the source that was set last is empty or a null pointer");
    if (is_target_refused_)
      return ("the target that was set last is empty or a null pointer");
    if (!input_ || !target_)
      return (std::string("no ") + (input_ ? "target" : "source") + " has been set");
    if (input_->empty() || target_->empty())
      return (std::string("the ") + (input_->empty() ? "source" : "target") +
              " has no points");
    if (!correspondence_estimation_ || !transformation_estimation_)
      return ("an estimation is a null pointer");
    // PCL adapts indices of its own to the source.
    for (const IndicesConstPtr& selected :
         {IndicesConstPtr(fake_indices_ ? nullptr : indices_),
          IndicesConstPtr(givenSourceIndices(*correspondence_estimation_))})
      if (selected && !areWithin(*selected, input_->size()))
        return ("an index is outside the source of " + std::to_string(input_->size()) +
                " points");
    const IndicesConstPtr selected = correspondence_estimation_->getIndicesTarget();
    if (selected && !force_no_recompute_ && !areWithin(*selected, target_->size()))
      return ("an index is outside the target of " + std::to_string(target_->size()) +
              " points");
    return ("");
  }

  /** The source points selected by the indices of this object and by those of the
   * correspondence estimation. An empty list here means the whole cloud, as it does to
   * pcl::IterativeClosestPoint. */
  Indices
  selectedPoints() const
  {
    Indices selected = *indices_;
    if (selected.empty()) {
      selected.resize(input_->size());
      std::iota(selected.begin(), selected.end(), 0);
    }
    const IndicesPtr given = givenSourceIndices(*correspondence_estimation_);
    if (!given)
      return (selected);
    std::vector<bool> is_selected(input_->size(), false);
    for (const auto index : selected)
      is_selected[static_cast<std::size_t>(index)] = true;
    selected.clear();
    for (const auto index : *given)
      if (is_selected[static_cast<std::size_t>(index)])
        selected.push_back(index);
    return (selected);
  }

  void
  fail(PointCloudSource& output,
       const Matrix4& guess,
       bool is_input_valid,
       const std::string& reason)
  {
    PCL_ERROR("[pcl::%s::computeTransformation] No registration: %s.\n",
              getClassName().c_str(),
              reason.c_str());
    forgetResult();
    keepFailure(is_input_valid, reason.c_str());
    nr_iterations_ = 0;
    converged_ = false;
    this->transformation_ = this->previous_transformation_ = Matrix4::Identity();
    correspondences_->clear();
    convergence_criteria_->setConvergenceState(
        State::CONVERGENCE_CRITERIA_NO_CORRESPONDENCES);
    const bool is_guess_finite = guess.template cast<float>().allFinite();
    final_transformation_ = is_guess_finite ? guess : Matrix4(Matrix4::Identity());
    if (is_source_refused_ || !input_) {
      output.clear();
      return;
    }
    output = *input_;
    if (is_guess_finite)
      transformCloud(*input_, output, guess);
  }

  /** Whether the cloud that was set last was refused, and PCL has an older one. */
  bool is_source_refused_ = false;
  bool is_target_refused_ = false;

  /** PCL's class keeps it for itself. */
  PointRepresentationConstPtr point_representation_;
};

} // namespace bayesian_icp_detail
} // namespace pcl

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
