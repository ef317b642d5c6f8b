// What a user installs in the registration is honoured by ICP and by the sampler:
// indices, correspondence estimation, rejectors, trees, representation, estimation.
#include "support/registration_support.h"

#include <pcl/registration/correspondence_rejection_median_distance.h>
#include <pcl/registration/correspondence_rejection_one_to_one.h>
#include <pcl/registration/correspondence_rejection_surface_normal.h>
#include <pcl/registration/transformation_estimation_2D.h>
#include <pcl/registration/transformation_estimation_3point.h>
#include <pcl/registration/transformation_estimation_point_to_plane.h>
#include <pcl/registration/transformation_estimation_point_to_plane_lls.h>
#include <pcl/registration/transformation_estimation_symmetric_point_to_plane_lls.h>

#include <initializer_list>
#include <stdexcept>
#include <vector>

namespace pcl::test {
namespace {

/** Two registrations of preset paper, of which one is to get plug-ins. */
class PluginTest : public ScansTest {
protected:
  PluginTest()
  {
    for (BayesianIcp* registration : {&icp, &plain})
      usePaper(*registration);
  }

  BayesianIcp icp, plain;
};

/** Of another type than PCL's, so that the class asks it itself. */
struct OwnEstimation : Estimation {};

/** Rejects nothing. */
const registration::CorrespondenceRejectorDistance::Ptr no_limit = rejectorBeyond(1e3f);

TEST_F(PluginTest, IndicesOfTheEstimationApplyToIcpAndToEveryMiniBatch)
{
  const IndicesPtr indices = everyNth(100, 900, 3);
  const pcl::shared_ptr<Estimation> estimation(new Estimation);
  estimation->setIndicesSource(indices);
  Icp reference;
  reference.setCorrespondenceEstimation(estimation);
  align(reference);
  plain.setIndices(indices);
  for (const bool has_rejector : {false, true}) {
    if (has_rejector) {
      icp.addCorrespondenceRejector(no_limit);
      plain.addCorrespondenceRejector(no_limit);
    }
    icp.setCorrespondenceEstimation(estimation);
    align(icp);
    align(plain);
    EXPECT_EQ(icp.getFinalTransformation(), reference.getFinalTransformation());
    EXPECT_EQ(icp.getSamples(), plain.getSamples());
    EXPECT_EQ(estimation->getIndicesSource(), indices);
  }
}

TEST_F(PluginTest, AChainThatRunsAwayDoesNotReachThePlugins)
{
  // Without a prior nothing stops it, and PCL's trees assert that queries are finite.
  icp.addCorrespondenceRejector(no_limit);
  icp.setPrior(bayesian_icp::Vector6d::Constant(std::nan("")),
               bayesian_icp::Vector6d::Constant(HUGE_VAL));
  bayesian_icp::Options options = icp.getOptions();
  options.paper.sgld.step_size = 1e40;
  icp.setOptions(options);
  align(icp);
  EXPECT_TRUE(icp.hasConverged());
  EXPECT_NE(icp.getSummary().status, bayesian_icp::Status::Ok);
}

TEST_F(PluginTest, OwnEstimationIsAskedByIcpAndByEveryStep)
{
  const auto estimation = pcl::make_shared<CountingEstimation>();
  icp.setCorrespondenceEstimation(estimation);
  align(icp);
  struct Exposed : Icp {
    using Icp::nr_iterations_;
  } reference;
  align(reference);
  const std::size_t n = scans.source->size();
  EXPECT_EQ(icp.getFinalTransformation(), reference.getFinalTransformation());
  // ICP's iterations, the count at the guess, 40 mini-batches of 20.
  EXPECT_EQ(estimation->num_points,
            static_cast<std::size_t>(reference.nr_iterations_) * n + n + 40UL * 20UL);
  EXPECT_EQ(icp.getSamples().rows(), 40);
}

TEST_F(PluginTest, ExceptionsOfPluginsPassThroughAndTheObjectStaysUsable)
{
  struct Throwing : Estimation {
    void
    determineCorrespondences(Correspondences& c, double max_distance) override
    {
      if (input_->size() == 20) // a mini-batch
        throw std::runtime_error("sensor unplugged");
      Estimation::determineCorrespondences(c, max_distance);
    }
  };
  icp.setCorrespondenceEstimation(pcl::shared_ptr<Throwing>(new Throwing));
  icp.setIndices(everyNth(10, 250, 10));
  EXPECT_THROW(align(icp), std::runtime_error);
  EXPECT_EQ(icp.getInputSource(), scans.source);
  icp.setCorrespondenceEstimation(pcl::shared_ptr<Estimation>(new Estimation));
  align(icp);
  EXPECT_TRUE(icp.hasConverged());
  EXPECT_EQ(icp.getSamples().rows(), 40);
}

TEST_F(PluginTest, ARejectorThatRejectsNothingChangesNothing)
{
  align(plain);
  icp.addCorrespondenceRejector(no_limit);
  align(icp);
  EXPECT_EQ(icp.getFinalTransformation(), plain.getFinalTransformation());
  // Only the points are moved in float here and in double there.
  EXPECT_LT((icp.getSamples().row(0) - plain.getSamples().row(0)).norm(), 1e-5);
}

TEST_F(PluginTest, ReciprocityIsThatOfTheWholeSourceAlsoWithRejectors)
{
  plain.setUseReciprocalCorrespondences(true);
  align(plain);
  icp.setUseReciprocalCorrespondences(true);
  icp.addCorrespondenceRejector(no_limit);
  align(icp);
  EXPECT_EQ(icp.getSamples(), plain.getSamples());
}

/** Has data of its own for every source point: whether its pairs may be kept. */
struct Knowing : registration::CorrespondenceRejectorOneToOne {
  explicit Knowing(const Cloud& source)
  {
    for (const PointXYZ& point : source)
      is_good.push_back(point.x > -0.2f);
  }

  void
  getRemainingCorrespondences(const Correspondences& in, Correspondences& out) override
  {
    out.clear();
    for (const auto& pair : in)
      if (is_good.at(static_cast<std::size_t>(pair.index_query)))
        out.push_back(pair);
  }

  std::vector<bool> is_good;
};

TEST_F(PluginTest, PluginsKnowPointsByTheirIndexInTheSource)
{
  const IndicesPtr odd = everyNth(1, 900, 2), usable(new Indices);
  for (const index_t i : *odd)
    if (i % 7 == 0)
      (*scans.source)[i].y = nan_value;
    else
      usable->push_back(i);
  const auto subset = pcl::make_shared<Cloud>(*scans.source, *usable);
  const auto ready_tree = pcl::make_shared<Tree>();
  ready_tree->setInputCloud(scans.source, usable);
  // PCL's ICP leaves points out by the indices of its estimation only.
  const auto estimation = pcl::make_shared<Estimation>();
  estimation->setIndicesSource(usable);
  Icp reference;
  reference.setCorrespondenceEstimation(estimation);
  icp.setIndices(odd);
  for (Icp* registration : std::initializer_list<Icp*>{&reference, &icp})
    registration->addCorrespondenceRejector(pcl::make_shared<Knowing>(*scans.source));
  plain.addCorrespondenceRejector(pcl::make_shared<Knowing>(*subset));
  const auto expectSame = [&] {
    align(reference);
    align(icp);
    EXPECT_EQ(icp.getFinalTransformation(), reference.getFinalTransformation());
    EXPECT_TRUE(icp.hasConverged());
    aligned(plain, subset, scans.target);
    EXPECT_EQ(icp.getSamples(), plain.getSamples());
    EXPECT_GT(icp.getSamples().rows(), 0);
  };
  expectSame();
  for (Icp* registration : std::initializer_list<Icp*>{&reference, &icp, &plain})
    registration->setUseReciprocalCorrespondences(true);
  expectSame();
  for (Icp* registration : std::initializer_list<Icp*>{&reference, &icp})
    registration->setSearchMethodSource(ready_tree, true);
  expectSame();
}

TEST_F(PluginTest, ADistanceRejectorActsAsTheGate)
{
  plain.setMaxCorrespondenceDistance(0.05);
  align(plain);
  icp.addCorrespondenceRejector(rejectorBeyond(0.05f));
  align(icp);
  EXPECT_EQ(icp.getSamples().rows(), plain.getSamples().rows());
  EXPECT_LT((icp.getChain(0).row(0) - plain.getChain(0).row(0)).norm(), 1e-5);
}

TEST_F(PluginTest, RejectorsAreAppliedInOrderEachToTheOthersOutput)
{
  struct Recording : registration::CorrespondenceRejectorMedianDistance {
    void
    getRemainingCorrespondences(const Correspondences& in,
                                Correspondences& out) override
    {
      CorrespondenceRejectorMedianDistance::getRemainingCorrespondences(in, out);
      last_in = in.size();
      last_out = out.size();
    }
    std::size_t last_in = 0, last_out = 0;
  };
  const pcl::shared_ptr<Recording> first(new Recording), second(new Recording);
  first->setMedianFactor(1.0);
  second->setMedianFactor(1.0);
  icp.addCorrespondenceRejector(first);
  icp.addCorrespondenceRejector(second);
  align(icp);
  EXPECT_EQ(first->last_in, 20u); // the last mini-batch
  EXPECT_LT(first->last_out, first->last_in);
  EXPECT_EQ(second->last_in, first->last_out);
}

TEST(Plugins, RejectorsThatNeedNormalsGetThoseOfTheMovedMiniBatch)
{
  Scans<PointNormal> scans;
  // The guess turns the source by half a turn, and its normals have to turn with it: as
  // they are in the file, all pairs would be rejected.
  const Eigen::Matrix4f half_turn =
      Eigen::Vector4f(-1.0f, 1.0f, -1.0f, 1.0f).asDiagonal().toDenseMatrix();
  for (auto* cloud : {&*scans.source, &*scans.target})
    for (auto& point : *cloud)
      point.getNormalVector3fMap() = Eigen::Vector3f::UnitZ();
  transformPointCloudWithNormals(*scans.source, *scans.source, half_turn);
  using Rejector = registration::CorrespondenceRejectorSurfaceNormal;
  Rejector::Ptr rejector(new Rejector);
  rejector->setThreshold(0.5);
  BayesianIterativeClosestPoint<PointNormal, PointNormal> icp;
  usePaper(icp);
  icp.addCorrespondenceRejector(rejector);
  const QuietConsole quiet;
  aligned(icp, scans.source, scans.target, half_turn);
  EXPECT_TRUE(icp.hasConverged());
  EXPECT_GT(icp.getSamples().rows(), 0);
}

TEST_F(PluginTest, OwnSearchTreeIsAskedByEveryStep)
{
  const auto tree = pcl::make_shared<OwnSearch>();
  icp.setMaximumIterations(1);
  icp.setSearchMethodTarget(tree);
  align(icp);
  const std::size_t n = scans.source->size();
  EXPECT_EQ(tree->num_queries, n + n + 40UL * 20UL);
}

/** Runs preset exact against \p target, which holds the true target and then a decoy at
 * the identity, and returns how far the mean is from the truth. */
double
yawErrorOfExact(BayesianIcp& icp, const Cloud::Ptr& target)
{
  bayesian_icp::Options options = icp.getOptions();
  options.preset = bayesian_icp::Preset::Exact;
  options.chains.num_draws = 200;
  options.exact.scale.measurement_sigma = 0.005;
  options.exact.scale.effective_points = 150;
  options.exact.initial_spread =
      bayesian_icp::Vector6d(bayesian_icp::Vector6d::Constant(0.001));
  icp.setOptions(options);
  icp.setInputTarget(target);
  Cloud output;
  icp.align(output);
  return (std::abs(icp.getMean()[5] - smallPose()[5]));
}

TEST_F(PluginTest, PresetExactSearchesTheSelectedTargetPointsOnly)
{
  const Cloud::Ptr with_decoy(new Cloud(*scans.target));
  *with_decoy += *scans.source;
  const IndicesPtr selected = everyNth(0, 900);

  BayesianIcp all_points, with_tree;
  for (BayesianIcp* registration : {&all_points, &icp, &with_tree}) {
    registration->setInputSource(scans.source);
    registration->setIndices(everyNth(0, 900, 6)); // PCL's tree is slow
  }
  EXPECT_GT(yawErrorOfExact(all_points, with_decoy), 0.04);

  const pcl::shared_ptr<Estimation> estimation(new Estimation);
  estimation->setIndicesTarget(selected);
  icp.setCorrespondenceEstimation(estimation);
  EXPECT_LT(yawErrorOfExact(icp, with_decoy), 0.02);

  const Tree::Ptr ready_tree(new Tree);
  ready_tree->setInputCloud(with_decoy, selected);
  with_tree.setSearchMethodTarget(ready_tree, true);
  EXPECT_LT(yawErrorOfExact(with_tree, with_decoy), 0.02);
}

TEST_F(PluginTest, ThePluginsHaveTheTargetAlsoWhereIcpDoesNotRun)
{
  const Cloud::Ptr smaller(new Cloud(*scans.target, *everyNth(0, 500)));
  const pcl::shared_ptr<Estimation> selecting(new Estimation);
  selecting->setIndicesTarget(everyNth(0, 500, 2));
  const auto setUp = [&](BayesianIcp& registration, int kind) {
    if (kind == 0)
      registration.setCorrespondenceEstimation(selecting);
    else if (kind == 1)
      registration.setCorrespondenceEstimation(
          pcl::shared_ptr<OwnEstimation>(new OwnEstimation));
    else
      registration.addCorrespondenceRejector(rejectorBeyond(1e3f));
  };
  for (const int kind : {0, 1, 2}) {
    BayesianIcp with_icp, with_mean;
    setUp(with_icp, kind);
    setUp(with_mean, kind);
    for (BayesianIcp* registration : {&with_icp, &with_mean}) {
      usePaper(*registration);
      registration->setInputSource(scans.source);
    }
    with_mean.setUseMeanAsFinalTransformation(true);
    for (const Cloud::Ptr& target : {scans.target, smaller}) {
      aligned(with_icp, scans.source, target);
      aligned(with_mean, scans.source, target);
      EXPECT_EQ(with_mean.getSamples(), with_icp.getSamples()) << kind;
      EXPECT_GT(with_icp.getSamples().rows(), 0) << kind;
    }
  }
}

TEST_F(PluginTest, PointRepresentationOfTheTreeIsHonoured)
{
  // Correspondences, and with them the draws, must differ from the default's.
  icp.setMaximumIterations(1);
  align(icp);
  const auto by_all_coordinates = icp.getSamples();
  icp.setPointRepresentation(pcl::make_shared<TenfoldHeights>());
  align(icp);
  ASSERT_EQ(icp.getSamples().rows(), 40);
  EXPECT_GT((icp.getSamples() - by_all_coordinates).norm(), 1e-3);
}

TEST_F(PluginTest, VisualizationCallbackIsCalledOnceAnIcpIteration)
{
  int num_calls = 0;
  std::function<Registration<PointXYZ, PointXYZ>::UpdateVisualizerCallbackSignature>
      callback = [&](const Cloud&, const Indices&, const Cloud&, const Indices&) {
        ++num_calls;
      };
  icp.setInputSource(scans.source);
  icp.setInputTarget(scans.target);
  EXPECT_TRUE(icp.registerVisualizationCallback(callback));
  const int at_registration = num_calls;
  icp.setMaximumIterations(5);
  icp.setTransformationEpsilon(0.0);
  align(icp);
  EXPECT_EQ(num_calls - at_registration, 5);
}

TEST_F(PluginTest, TheMeanStaysWithinWhatAPlanarEstimationAllows)
{
  using Planar = registration::TransformationEstimation2D<PointXYZ, PointXYZ>;
  icp.setTransformationEstimation(pcl::shared_ptr<Planar>(new Planar));
  icp.setUseMeanAsFinalTransformation(true);
  align(icp);
  const Eigen::Matrix4f T = icp.getFinalTransformation();
  EXPECT_NEAR(T(2, 2), 1.0f, 1e-6f);
  EXPECT_NEAR(T(2, 3), 0.0f, 1e-6f);
  // It is what that estimation makes of the source moved to the mean.
  Cloud at_mean;
  transformPointCloud(*scans.source, at_mean, icp.getMeanTransformation());
  Eigen::Matrix4f expected;
  Planar().estimateRigidTransformation(*scans.source, at_mean, expected);
  EXPECT_GT((icp.getMeanTransformation() - expected).norm(), 1e-3f);
  EXPECT_LT((T - expected).norm(), 1e-5f);
}

TEST_F(PluginTest, NoPosteriorIsLeftWhereTheEstimationThrowsOnTheWayToTheMean)
{
  using namespace registration;
  struct Throwing : TransformationEstimationSVD<PointXYZ, PointXYZ> {
    void
    estimateRigidTransformation(const PointCloud<PointXYZ>& /* source */,
                                const PointCloud<PointXYZ>& /* target */,
                                Matrix4& /* transformation */) const override
    {
      throw std::runtime_error("of the user");
    }
  };
  icp.setTransformationEstimation(pcl::shared_ptr<Throwing>(new Throwing));
  icp.setUseMeanAsFinalTransformation(true);
  EXPECT_THROW(align(icp), std::runtime_error);
  EXPECT_FALSE(icp.hasConverged());
  EXPECT_EQ(icp.getSummary().status, bayesian_icp::Status::NotRun);
  EXPECT_EQ(icp.getSamples().rows(), 0);
}

TEST(Plugins, TheMeanIsTheFinalTransformationOfAPointToPlaneEstimation)
{
  using namespace registration;
  using P = PointNormal;
  Scans<P> scans; // without normals
  const QuietConsole quiet;
  const TransformationEstimation<P, P>::Ptr estimations[] = {
      pcl::make_shared<TransformationEstimationPointToPlane<P, P>>(),
      pcl::make_shared<TransformationEstimationPointToPlaneLLS<P, P>>(),
      pcl::make_shared<TransformationEstimationSymmetricPointToPlaneLLS<P, P>>()};
  for (const auto& estimation : estimations) {
    BayesianIterativeClosestPoint<P, P> icp;
    usePaper(icp);
    icp.setTransformationEstimation(estimation);
    icp.setUseMeanAsFinalTransformation(true);
    aligned(icp, scans.source, scans.target);
    const Eigen::Matrix4f mean = icp.getMeanTransformation();
    EXPECT_GT((mean - Eigen::Matrix4f::Identity()).norm(), 1e-2f);
    EXPECT_TRUE(icp.hasConverged());
    EXPECT_LT((icp.getFinalTransformation() - mean).cwiseAbs().maxCoeff(), 1e-5f);
  }
}

TEST_F(PluginTest, IcpRunsWhereTheEstimationKnowsNoMotionToTheMean)
{
  using ThreePoints = registration::TransformationEstimation3Point<PointXYZ, PointXYZ>;
  const auto estimation = pcl::make_shared<ThreePoints>();
  for (BayesianIcp* registration : {&icp, &plain})
    registration->setTransformationEstimation(estimation);
  icp.setUseMeanAsFinalTransformation(true);
  const QuietConsole quiet;
  align(icp);
  align(plain);
  EXPECT_EQ(icp.getFinalTransformation(), plain.getFinalTransformation());
  EXPECT_EQ(icp.hasConverged(), plain.hasConverged());

  // Cancelled there, it keeps the posterior that it has.
  usePaper(icp);
  icp.setProgressCallback(
      [](const bayesian_icp::Progress& p) { return (p.total_steps > 0); });
  align(icp);
  EXPECT_FALSE(icp.hasConverged());
  EXPECT_NE(icp.getSummary().status, bayesian_icp::Status::Cancelled);
  EXPECT_GT(icp.getSummary().num_draws, 0);
}

TEST_F(PluginTest, PresetExactNeedsAGateWherePairsMayBeDropped)
{
  for (const bool is_reciprocal : {false, true}) {
    BayesianIcp registration;
    registration.setPreset(bayesian_icp::Preset::Exact);
    registration.setNumberOfSamples(200);
    if (is_reciprocal)
      registration.setUseReciprocalCorrespondences(true);
    else
      registration.addCorrespondenceRejector(rejectorBeyond(0.05f));
    {
      const QuietConsole quiet;
      align(registration);
    }
    EXPECT_EQ(registration.getSummary().status, bayesian_icp::Status::InvalidOptions);
    EXPECT_NE(registration.getSummary().message.find("max_distance"),
              std::string::npos);
    EXPECT_TRUE(registration.hasConverged());
    registration.setMaxCorrespondenceDistance(0.05);
    align(registration);
    EXPECT_EQ(registration.getSamples().rows(), 200);
  }
}

TEST_F(PluginTest, TheFastSearchFindsWhatPclsEstimationFinds)
{
  for (const bool is_reciprocal : {false, true}) {
    const double max_distance = 0.03;
    const IndicesPtr indices = everyNth(0, 900);
    Tree::Ptr tree(new Tree);
    tree->setInputCloud(scans.target);
    const bayesian_icp_detail::KdTreeSearch<PointXYZ, PointXYZ> search(
        tree,
        scans.target,
        max_distance,
        indices,
        is_reciprocal ? scans.source : nullptr);
    const std::vector<std::size_t> all(indices->begin(), indices->end());
    bayesian_icp::Random random(3, 0);
    std::size_t num_compared = 0;
    for (int repeat = 0; repeat < 10; ++repeat) {
      const bayesian_icp::Vector6d pose = smallPose() + 0.02 * random.normal6();
      Cloud::Ptr moved(new Cloud);
      transformPointCloud(*scans.source, *moved, bayesian_icp::matrixOf(pose));
      bayesian_icp::Correspondences found;
      search.find(pose, all, bayesian_icp_detail::pointMatrix(*moved), found);

      Estimation estimation;
      estimation.setInputSource(moved);
      estimation.setInputTarget(scans.target);
      Correspondences expected;
      if (is_reciprocal)
        estimation.determineReciprocalCorrespondences(expected, max_distance);
      else
        estimation.determineCorrespondences(expected, max_distance);
      ASSERT_EQ(found.size(), expected.size());
      for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found[i].source_index,
                  static_cast<std::size_t>(expected[i].index_query));
        EXPECT_EQ(found[i].target_point.cast<float>(),
                  (*scans.target)[expected[i].index_match].getVector3fMap());
      }
      num_compared += found.size();
    }
    EXPECT_GT(num_compared, 1000u);
    EXPECT_LT(num_compared, 10 * all.size()); // the gate, or reciprocity, did reject
  }
}

} // namespace
} // namespace pcl::test
