// The registration that is inside pcl::BayesianIterativeClosestPoint is that of
// pcl::IterativeClosestPoint to the last bit, whichever tree has found the pairs.
#include "class/scan_pair.h"

#include <pcl/registration/correspondence_rejection_median_distance.h>
#include <pcl/registration/correspondence_rejection_one_to_one.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace pcl::test {
namespace {

using OneToOne = registration::CorrespondenceRejectorOneToOne;
using Median = registration::CorrespondenceRejectorMedianDistance;

/** What align() leaves behind. */
struct Snapshot {
  Eigen::Matrix4d final_transformation, last_increment, previous_increment;
  bool has_converged;
  int state;
  int num_iterations;
  Correspondences correspondences;
  Cloud output;
  double fitness;
};

/** A registration that keeps a snapshot of every align(). */
template <typename Registration>
struct Recorder : Registration {
  void
  alignAndRecord(const Eigen::Matrix4d& guess)
  {
    Snapshot now;
    this->align(now.output,
                guess.template cast<typename Registration::Matrix4::Scalar>());
    now.final_transformation = this->final_transformation_.template cast<double>();
    now.last_increment = this->transformation_.template cast<double>();
    now.previous_increment = this->previous_transformation_.template cast<double>();
    now.has_converged = this->converged_;
    now.state = this->convergence_criteria_->getConvergenceState();
    now.num_iterations = this->nr_iterations_;
    now.correspondences = *this->correspondences_;
    now.fitness = this->getFitnessScore();
    snapshots.push_back(now);
  }

  std::vector<Snapshot> snapshots;
};

void
expectSamePairs(const Correspondences& actual, const Correspondences& expected)
{
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t i = 0; i < actual.size(); ++i) {
    ASSERT_EQ(actual[i].index_query, expected[i].index_query);
    ASSERT_EQ(actual[i].index_match, expected[i].index_match);
    ASSERT_EQ(actual[i].distance, expected[i].distance);
  }
}

void
expectSame(const Snapshot& actual, const Snapshot& expected)
{
  EXPECT_EQ(actual.final_transformation, expected.final_transformation);
  EXPECT_EQ(actual.last_increment, expected.last_increment);
  EXPECT_EQ(actual.previous_increment, expected.previous_increment);
  EXPECT_EQ(actual.has_converged, expected.has_converged);
  EXPECT_EQ(actual.state, expected.state);
  EXPECT_EQ(actual.num_iterations, expected.num_iterations);
  EXPECT_EQ(actual.fitness, expected.fitness);
  expectSamePairs(actual.correspondences, expected.correspondences);
  expectSamePoints(actual.output, expected.output);
}

using Align = std::function<void(const Eigen::Matrix4d& guess)>;

/** Does the same with PCL's class and with ours.
 * \param[in] work what a user does, given a registration without clouds and an Align */
template <typename Scalar = float, typename Work>
void
expectTheRegistrationOfIcp(const Work& work)
{
  using Reference = IterativeClosestPoint<PointXYZ, PointXYZ, Scalar>;
  using Bayesian = BayesianIterativeClosestPoint<PointXYZ, PointXYZ, Scalar>;
  const auto snapshotsOf = [&work](auto& recorder) {
    Reference& icp = recorder;
    work(icp, [&recorder](const auto& guess) { recorder.alignAndRecord(guess); });
    return (recorder.snapshots);
  };
  const QuietConsole quiet;
  Recorder<Reference> reference;
  const auto expected = snapshotsOf(reference);
  ASSERT_FALSE(expected.empty());
  for (const unsigned int num_threads : {1, 3}) {
    Recorder<Bayesian> bayesian;
    usePaper(bayesian);
    bayesian.setNumberOfThreads(num_threads);
    const auto actual = snapshotsOf(bayesian);
    ASSERT_EQ(actual.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      SCOPED_TRACE("align() number " + std::to_string(i));
      expectSame(actual[i], expected[i]);
    }
  }
}

/** Every \p step-th point. */
Cloud::Ptr
thinned(const Cloud& cloud, index_t step)
{
  return (pcl::make_shared<Cloud>(
      cloud, *everyNth(0, static_cast<index_t>(cloud.size()), step)));
}

/** On a lattice of 1/32 m: many points equally near, and repeated points. */
Cloud::Ptr
onLattice(const Cloud& cloud)
{
  Cloud::Ptr rounded(new Cloud(cloud));
  for (auto& point : *rounded)
    point.getVector3fMap() =
        (32.0f * point.getVector3fMap().array()).round().matrix() / 32.0f;
  return (rounded);
}

const Eigen::Matrix4d no_guess = Eigen::Matrix4d::Identity();

class DropInOnScans : public ::testing::TestWithParam<const char*> {
protected:
  const ScanPair scans{GetParam()};
  const Cloud::Ptr source = thinned(*scans.source, 7);
  const Cloud::Ptr target = thinned(*scans.target, 5);
};

TEST_P(DropInOnScans, IsTheRegistrationOfIcp)
{
  expectTheRegistrationOfIcp([this](Icp& icp, const Align& align) {
    icp.setInputSource(source);
    icp.setInputTarget(target);
    align(no_guess);
    icp.setMaxCorrespondenceDistance(0.02);
    align(bayesian_icp::matrixOf(smallPose()));
  });
  expectTheRegistrationOfIcp<double>([this](auto& icp, const Align& align) {
    icp.setInputSource(source);
    icp.setInputTarget(target);
    align(no_guess);
  });
}

INSTANTIATE_TEST_SUITE_P(
    Data,
    DropInOnScans,
    ::testing::Values("bowl", "can", "corridor", "mug", "table", "table_top"),
    [](const auto& scene) { return std::string(scene.param); });

/** Whether target points are equally near to some of the queries. */
class DropInClouds : public ::testing::TestWithParam<bool> {
protected:
  DropInClouds()
  {
    Scans<PointXYZ> scans;
    if (GetParam())
      for (auto* cloud : {&scans.source, &scans.target})
        *cloud = onLattice(**cloud);
    source = scans.source;
    target = scans.target;
  }

  /** With the clouds of this test.
   * \param[in] work as of expectTheRegistrationOfIcp() */
  template <typename Work>
  void
  expectSameAfter(const Work& work)
  {
    expectTheRegistrationOfIcp([&](Icp& icp, const Align& align) {
      icp.setInputSource(source);
      icp.setInputTarget(target);
      work(icp, align);
    });
  }

  void
  expectSameWith(const std::function<void(Icp&)>& settings)
  {
    expectSameAfter([&](Icp& icp, const Align& align) {
      settings(icp);
      align(no_guess);
      align(bayesian_icp::matrixOf(smallPose()));
    });
  }

  /** The target, moved along x. */
  Cloud::Ptr
  otherTarget() const
  {
    const Cloud::Ptr other(new Cloud(*target));
    for (auto& point : *other)
      point.x += 0.03f;
    return (other);
  }

  Cloud::Ptr source, target;
};

TEST_P(DropInClouds, WithDefaultsAndWithGates)
{
  expectSameWith([](Icp&) {});
  for (const double gate : {0.02, -0.02, 0.0, 1e-30, 1e30, std::nan("")})
    expectSameWith([&](Icp& icp) { icp.setMaxCorrespondenceDistance(gate); });
}

TEST_P(DropInClouds, WithCriteria)
{
  expectSameWith([](Icp& icp) { icp.setMaximumIterations(0); });
  expectSameWith([](Icp& icp) { icp.setEuclideanFitnessEpsilon(0.1); });
  expectSameWith([](Icp& icp) {
    icp.setMaximumIterations(200);
    icp.setTransformationEpsilon(1e-10);
  });
  expectSameWith([](Icp& icp) {
    icp.setMaximumIterations(3);
    icp.getConvergeCriteria()->setFailureAfterMaximumIterations(true);
  });
}

TEST_P(DropInClouds, WithRejectors)
{
  expectSameWith([](Icp& icp) {
    icp.addCorrespondenceRejector(pcl::make_shared<OneToOne>());
    icp.addCorrespondenceRejector(pcl::make_shared<Median>());
  });
}

TEST_P(DropInClouds, WithReciprocalPairs)
{
  expectSameWith([](Icp& icp) { icp.setUseReciprocalCorrespondences(true); });
}

TEST_P(DropInClouds, WithTreesOfTheUserAlsoOfHalfOfTheTarget)
{
  expectSameWith([](Icp& icp) { icp.setSearchMethodTarget(pcl::make_shared<Tree>()); });
  expectSameWith([this](Icp& icp) {
    const auto tree = pcl::make_shared<Tree>();
    tree->setInputCloud(target, everyNth(0, 900, 2));
    icp.setSearchMethodTarget(tree, true);
  });
}

/** Has null inside, and nothing in its place. PCL's functions dereference it. */
struct Hollow : Tree {
  Hollow() { tree_.reset(); }
};

TEST_P(DropInClouds, WithTreesThatSearchByThemselves)
{
  expectSameWith([](Icp& icp) {
    icp.setUseReciprocalCorrespondences(true);
    icp.setSearchMethodTarget(pcl::make_shared<OwnSearch>());
    icp.setSearchMethodSource(pcl::make_shared<OwnSearch>());
  });
  expectSameWith([this](Icp& icp) {
    const auto tree = pcl::make_shared<OwnSearch>();
    tree->setInputCloud(target);
    icp.setSearchMethodTarget(tree, true);
  });
}

TEST_P(DropInClouds, WithPointRepresentations)
{
  expectSameWith(
      [](Icp& icp) { icp.setPointRepresentation(pcl::make_shared<TenfoldHeights>()); });
  expectSameWith([](Icp& icp) {
    const auto estimation = pcl::make_shared<Estimation>();
    estimation->setPointRepresentation(pcl::make_shared<TenfoldHeights>());
    icp.setCorrespondenceEstimation(estimation);
  });
}

TEST_P(DropInClouds, WithTargetIndicesOfTheEstimation)
{
  expectSameAfter([&](Icp& icp, const Align& align) {
    const auto estimation = pcl::make_shared<Estimation>();
    estimation->setIndicesTarget(everyNth(0, 900, 2));
    icp.setCorrespondenceEstimation(estimation);
    align(no_guess);
    icp.setCorrespondenceEstimation(pcl::make_shared<Estimation>());
    align(no_guess);
  });
}

TEST_P(DropInClouds, WithSourceIndicesOfTheEstimation)
{
  for (const bool is_reciprocal : {false, true})
    expectSameWith([is_reciprocal](Icp& icp) {
      const auto estimation = pcl::make_shared<Estimation>();
      estimation->setIndicesSource(everyNth(100, 900, 3));
      icp.setCorrespondenceEstimation(estimation);
      icp.addCorrespondenceRejector(pcl::make_shared<OneToOne>());
      icp.setUseReciprocalCorrespondences(is_reciprocal);
    });
}

TEST_P(DropInClouds, WithTargetsThatChange)
{
  expectSameAfter([&](Icp& icp, const Align& align) {
    const Cloud::Ptr changing(new Cloud(*target));
    for (const auto& cloud : {changing, otherTarget(), changing}) {
      icp.setInputTarget(cloud);
      align(no_guess);
    }
    for (auto& point : *changing) // in place, and nobody is told
      point.y -= 0.04f;
    align(no_guess);
    icp.setUseReciprocalCorrespondences(true);
    align(no_guess);
    for (auto& point : *changing)
      point.y -= 0.02f;
    icp.setUseReciprocalCorrespondences(false);
    align(no_guess);
  });
}

TEST_P(DropInClouds, WithATreeThatAnotherRegistrationUsesToo)
{
  expectSameAfter([&](Icp& icp, const Align& align) {
    const auto tree = pcl::make_shared<Tree>();
    icp.setSearchMethodTarget(tree);
    align(no_guess);
    tree->setInputCloud(otherTarget());
    align(no_guess);
  });
}

TEST_P(DropInClouds, OneIterationAtATime)
{
  expectSameAfter([](Icp& icp, const Align& align) {
    icp.setMaximumIterations(1);
    Eigen::Matrix4d guess = no_guess;
    for (int i = 0; i < 5; ++i) {
      align(guess);
      guess = icp.getFinalTransformation().cast<double>();
    }
  });
}

TEST_P(DropInClouds, WithTargetPointsThatAreNotFinite)
{
  for (std::size_t i = 3; i < target->size(); i += 10)
    (*target)[i].y = nan_value;
  expectSameWith([](Icp&) {});
}

TEST_P(DropInClouds, ThePairsOfTheDefaultEstimationCanBeAskedForAfterwards)
{
  const auto pairsAfterAlign = [this](Icp& icp) {
    const auto estimation = pcl::make_shared<Estimation>();
    icp.setCorrespondenceEstimation(estimation);
    aligned(icp, source, target);
    Correspondences pairs;
    estimation->determineCorrespondences(pairs);
    return (pairs);
  };
  const QuietConsole quiet;
  Icp icp;
  BayesianIcp bayesian;
  usePaper(bayesian);
  expectSamePairs(pairsAfterAlign(bayesian), pairsAfterAlign(icp));
}

/** Calls the setters of our class, which PCL's class does not have. */
class DropInTrees : public DropInClouds {
protected:
  Snapshot
  alignedWith(const std::function<void(BayesianIcp&)>& settings,
              bayesian_icp::Preset preset = bayesian_icp::Preset::Paper)
  {
    Recorder<BayesianIcp> bayesian;
    useFewSamples(bayesian);
    bayesian.setPreset(preset);
    bayesian.setInputSource(source);
    bayesian.setInputTarget(target);
    settings(bayesian);
    bayesian.alignAndRecord(no_guess);
    num_draws = bayesian.getSummary().num_draws;
    return (bayesian.snapshots[0]);
  }

  const QuietConsole quiet;
  const Snapshot expected = alignedWith([](BayesianIcp&) {});
  std::size_t num_draws = 0;
};

TEST_P(DropInTrees, ATreeThatSearchesByItselfIsUsedByEveryPreset)
{
  for (const auto preset : {bayesian_icp::Preset::Paper,
                            bayesian_icp::Preset::Exact,
                            bayesian_icp::Preset::Calibrated}) {
    const auto tree = pcl::make_shared<OwnSearch>();
    expectSame(alignedWith([&](auto& icp) { icp.setSearchMethodTarget(tree); }, preset),
               expected);
    EXPECT_GT(tree->num_queries, 0u);
    EXPECT_GT(num_draws, 0u);
  }
}

TEST_P(DropInTrees, ATreeWithNothingInsideIsGivenATree)
{
  expectSame(alignedWith([](auto& icp) {
               icp.setSearchMethodTarget(pcl::make_shared<Hollow>());
             }),
             expected);
  const auto reciprocal = [](auto& icp) { icp.setUseReciprocalCorrespondences(true); };
  expectSame(alignedWith([&](auto& icp) {
               reciprocal(icp);
               icp.setSearchMethodSource(pcl::make_shared<Hollow>());
             }),
             alignedWith(reciprocal));
}

TEST_P(DropInTrees, ANullPointerInPlaceOfATreeIsRefused)
{
  expectSame(alignedWith([](auto& icp) {
               icp.setSearchMethodTarget(nullptr);
               icp.setSearchMethodTarget(nullptr, true);
               icp.setSearchMethodSource(nullptr);
             }),
             expected);
}

TEST_P(DropInTrees, ARepresentationThatTheTreeCannotBeToldOfIsRefused)
{
  const auto own_search = pcl::make_shared<OwnSearch>();
  expectSame(alignedWith([&](auto& icp) {
               icp.setSearchMethodTarget(own_search);
               icp.setPointRepresentation(pcl::make_shared<TenfoldHeights>());
             }),
             expected);
  const auto stretched = alignedWith([](auto& icp) {
    icp.setPointRepresentation(pcl::make_shared<TenfoldHeights>());
  });
  ASSERT_NE(stretched.final_transformation, expected.final_transformation);
  own_search->num_queries = 0;
  expectSame(alignedWith([&](auto& icp) {
               icp.setPointRepresentation(pcl::make_shared<TenfoldHeights>());
               icp.setSearchMethodTarget(own_search);
             }),
             stretched);
  EXPECT_EQ(own_search->num_queries, 0u);
  // Once it is not wanted any more, the tree is welcome.
  expectSame(alignedWith([&](auto& icp) {
               icp.setPointRepresentation(pcl::make_shared<TenfoldHeights>());
               icp.setPointRepresentation(nullptr);
               icp.setSearchMethodTarget(own_search);
             }),
             expected);
}

TEST(DropInTree, IsNotLookedIntoUnlessItIsOfPcl)
{
  EXPECT_FALSE(bayesian_icp_detail::isDefaultTree(Hollow()));
  EXPECT_FALSE(bayesian_icp_detail::isDefaultTree(OwnSearch()));
  EXPECT_TRUE(bayesian_icp_detail::isDefaultTree(Tree()));
}

TEST(DropInThreads, AreSetForIcpAndForThePosteriorByOneCall)
{
  BayesianIcp icp;
  icp.setNumberOfThreads(3);
  EXPECT_EQ(icp.getOptions().chains.num_threads, 3);
#if PCL_VERSION_COMPARE(>=, 1, 15, 0)
  struct Exposed : Estimation {
    using Estimation::num_threads_;
  };
  const auto estimation = pcl::make_shared<Exposed>();
  icp.setCorrespondenceEstimation(estimation);
  EXPECT_EQ(estimation->num_threads_, 1u); // as PCL's
  icp.setNumberOfThreads(3);
  EXPECT_EQ(estimation->num_threads_, 3u);
#else
  GTEST_SKIP() << "ICP of PCL before 1.15 has one thread";
#endif
}

const auto name_of_clouds = [](const auto& tied) {
  return tied.param ? "Tied" : "Unique";
};
INSTANTIATE_TEST_SUITE_P(UniqueAndTied, DropInTrees, ::testing::Bool(), name_of_clouds);
INSTANTIATE_TEST_SUITE_P(UniqueAndTied,
                         DropInClouds,
                         ::testing::Bool(),
                         name_of_clouds);

TEST(DropInTies, OccurOnTheLattice)
{
  const Scans<PointXYZ> scans;
  const auto numTied = [](const Cloud& source, const Cloud& target) {
    const bayesian_icp::KdTree tree(bayesian_icp_detail::pointMatrix<float>(target));
    return (std::count_if(source.begin(), source.end(), [&](const auto& point) {
      return (tree.nearest(point.getVector3fMap(), std::numeric_limits<float>::max())
                  .is_tied);
    }));
  };
  EXPECT_GT(numTied(*onLattice(*scans.source), *onLattice(*scans.target)), 100);
  EXPECT_EQ(numTied(*scans.source, *scans.target), 0);
}

} // namespace
} // namespace pcl::test
