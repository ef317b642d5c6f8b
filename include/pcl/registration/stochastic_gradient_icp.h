/** \file
 * \brief ICP by stochastic gradient descent as a PCL registration class.
 */
#pragma once

#include <bayesian_icp/stochastic_gradient_icp.h>

#include <pcl/registration/impl/checked_icp.hpp>

namespace pcl {

/** \brief Iterative closest point by stochastic gradient descent on mini-batches of the
 * source (SGD-ICP; Maken, Ramos, Ott: Speeding up Iterative Closest Point Using
 * Stochastic Gradient Descent, ICRA 2019).
 *
 * The class has the interface of pcl::IterativeClosestPoint. In each step, the
 * correspondence estimation, rejectors, search tree and maximum correspondence distance
 * of the object determine the pairs of a mini-batch. There is no closed-form step. If
 * the user has set a transformation estimation, it is called once, at the end, for the
 * nearest motion that it allows. The Euclidean fitness epsilon has no effect.
 *
 * setMaximumIterations() counts steps. As in PCL, setTransformationEpsilon() [m^2] is a
 * squared distance and setTransformationRotationEpsilon() the cosine of an angle. The
 * descent has converged when the translation and the sum of the changes of roll, pitch
 * and yaw stay within these limits for the number of consecutive steps given in the
 * options. As with PCL's ICP, hasConverged() is also true if the iterations ran out,
 * unless convergence_criteria_ states otherwise; getResult() distinguishes the two.
 *
 * Non-finite points, indices, refused clouds and exceptions are treated as in
 * pcl::BayesianIterativeClosestPoint. correspondences_ are those of the whole source at
 * the final transformation. The same seed gives the same result. Use one object from
 * one thread at a time.
 *
 * \tparam Scalar float or double, type of the transformations; the descent is in double
 * \ingroup registration
 */
template <typename PointSource, typename PointTarget, typename Scalar = float>
class StochasticGradientDescentIterativeClosestPoint
: public bayesian_icp_detail::
      CheckedIterativeClosestPoint<PointSource, PointTarget, Scalar> {
public:
  using Base = bayesian_icp_detail::
      CheckedIterativeClosestPoint<PointSource, PointTarget, Scalar>;
  using Ptr = shared_ptr<StochasticGradientDescentIterativeClosestPoint>;
  using ConstPtr = shared_ptr<const StochasticGradientDescentIterativeClosestPoint>;
  using Matrix4 = typename Base::Matrix4;
  using PointCloudSource = typename Base::PointCloudSource;
  using PointCloudSourceConstPtr = typename Base::PointCloudSourceConstPtr;
  using Options = bayesian_icp::StochasticGradientIcpOptions;
  using Result = bayesian_icp::StochasticGradientIcpResult;

  /** \brief Start with the defaults of Options, including the number of iterations and
   * the epsilons. */
  StochasticGradientDescentIterativeClosestPoint();

  /** \brief Set all options. The iterations and epsilons are copied to the settings of
   * PCL's class. align() reports options out of range. */
  void
  setOptions(const Options& options);

  /** \brief The options, with the iterations and epsilons of PCL's class. */
  Options
  getOptions() const;

  void
  setOptimizer(bayesian_icp::SgdOptimizer optimizer)
  {
    options_.optimizer = optimizer;
  }

  /** \brief Set the step size. NaN means the default of the optimiser. */
  void
  setStepSize(double step_size)
  {
    options_.step_size = step_size;
  }

  /** \brief Set the number of source points per step. */
  void
  setMiniBatchSize(int batch_size)
  {
    options_.batch_size = batch_size;
  }

  void
  setSeed(std::uint64_t seed)
  {
    options_.seed = seed;
  }

  /** \brief Set a function that is called after every step. It returns false to stop.
   */
  void
  setProgressCallback(const bayesian_icp::StochasticGradientIcpProgress& callback)
  {
    progress_callback_ = callback;
  }

  /** \brief Pose, number of steps and reason for the end of the last align(). */
  const Result&
  getResult() const
  {
    return (result_);
  }

  using Base::convergence_criteria_; // public in PCL's class, too
  using Base::getClassName;

protected:
  using Base::converged_;
  using Base::correspondences_;
  using Base::final_transformation_;
  using Base::input_;
  using Base::max_iterations_;
  using Base::nr_iterations_;
  using Base::previous_transformation_;
  using Base::reg_name_;
  using Base::target_;
  using Base::transformation_;
  using Base::transformation_epsilon_;
  using Base::transformation_rotation_epsilon_;
  using Base::update_visualizer_;
  using typename Base::State;

  void
  forgetResult() override
  {
    result_ = Result();
  }

  void
  registerUsable(const IndicesConstPtr& usable, const Matrix4& guess) override;

  void
  keepFailure(bool is_input_valid, const char* /* reason */) override
  {
    result_.end = is_input_valid ? bayesian_icp::DescentEnd::TooFewCorrespondences
                                 : bayesian_icp::DescentEnd::InvalidInput;
  }

private:
  using Search = bayesian_icp_detail::PairSearch<PointTarget>;

  /** \return whether Scalar can hold the pose; if not, nothing is done */
  bool
  takeStep(const Search& search,
           const Indices& usable,
           const bayesian_icp::Vector6d& pose);

  void
  findPairs(const Search& search, const Indices& usable);

  void
  publishEnd();

  Options options_;
  Result result_;
  bayesian_icp::StochasticGradientIcpProgress progress_callback_;
};

} // namespace pcl

#include <pcl/registration/impl/stochastic_gradient_icp.hpp>

#if !defined(PCL_NO_PRECOMPILE) &&                                                     \
    !defined(PCL_REGISTRATION_STOCHASTIC_GRADIENT_ICP_CPP_)
#define PCL_BAYESIAN_ICP_DECLARE(PointT, Scalar)                                       \
  extern template class pcl::                                                          \
      StochasticGradientDescentIterativeClosestPoint<PointT, PointT, Scalar>;
PCL_BAYESIAN_ICP_FOR_POINT_TYPES(PCL_BAYESIAN_ICP_DECLARE, float)
PCL_BAYESIAN_ICP_FOR_POINT_TYPES(PCL_BAYESIAN_ICP_DECLARE, double)
#undef PCL_BAYESIAN_ICP_DECLARE
#endif
