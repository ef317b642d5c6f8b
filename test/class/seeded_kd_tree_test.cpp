// The search tree of the registration classes answers as PCL's, whatever it is asked.
#include "support/registration_support.h"

#include <pcl/registration/impl/seeded_kd_tree.hpp>
#include <pcl/search/kdtree.h>

#include <cmath>
#include <functional>
#include <limits>
#include <thread>
#include <tuple>
#include <vector>

namespace pcl::test {
namespace {

using Seeded = bayesian_icp_detail::SeededKdTree<PointXYZ>;

/** Number, indices and squared distances of the points that a query finds. */
using Answer = std::tuple<int, Indices, std::vector<float>>;

/** \param[in] search fills in indices and squared distances, and returns their number
 */
template <typename Search>
std::vector<Answer>
answersTo(const Cloud& queries, const Search& search)
{
  std::vector<Answer> answers;
  for (const auto& query : queries) {
    auto& [number, indices, squared_distances] = answers.emplace_back();
    number = search(query, indices, squared_distances);
  }
  return (answers);
}

std::vector<Answer>
nearestTo(const Tree& tree, const Cloud& queries, int k)
{
  return (answersTo(queries, [&](const auto& query, auto& indices, auto& distances) {
    return (tree.nearestKSearch(query, k, indices, distances));
  }));
}

std::vector<Answer>
withinRadius(const Tree& tree, const Cloud& queries)
{
  return (answersTo(queries, [&](const auto& query, auto& indices, auto& distances) {
    return (tree.radiusSearch(query, 0.1, indices, distances));
  }));
}

/** Does the same with PCL's tree and with ours, and asks both. */
class SeededKdTreeTest : public ::testing::Test {
protected:
  void
  expectPclsAnswersAfter(const std::function<void(Tree&)>& work)
  {
    Tree pcls;
    Seeded ours;
    work(pcls);
    work(ours);
    EXPECT_EQ(ours.getInputCloud(), pcls.getInputCloud());
    EXPECT_EQ(ours.getIndices(), pcls.getIndices());
    EXPECT_EQ(ours.getEpsilon(), pcls.getEpsilon());
    for (const int k : {1, 5})
      EXPECT_EQ(nearestTo(ours, *source, k), nearestTo(pcls, *source, k)) << k;
    EXPECT_EQ(withinRadius(ours, *source), withinRadius(pcls, *source));
    // The radius has built PCL's tree, if nothing else had.
    EXPECT_EQ(ours.getEpsilon(), pcls.getEpsilon());
    EXPECT_EQ(nearestTo(ours, *source, 1), nearestTo(pcls, *source, 1));
  }

  const Cloud::Ptr source = bumpySurface<PointXYZ>(1),
                   target = bumpySurface<PointXYZ>(2);
};

TEST_F(SeededKdTreeTest, AnswersAsPclsAlsoWhereSeveralPointsAreAsNear)
{
  const auto give = [this](Tree& tree) { tree.setInputCloud(target); };
  expectPclsAnswersAfter(give);
  for (auto* cloud : {source.get(), target.get()})
    for (auto& point : *cloud)
      point.getVector3fMap() = (16.0f * point.getVector3fMap().array()).round() / 16.0f;
  expectPclsAnswersAfter(give);
}

TEST_F(SeededKdTreeTest, AnswersAsPclsWithoutPoints)
{
  const QuietConsole quiet;
  const Cloud::Ptr nowhere(new Cloud);
  nowhere->resize(3);
  for (auto& point : *nowhere)
    point.z = std::nanf("");
  Tree pcls;
  Seeded ours;
  // Within a radius PCL's tree finds nothing to look at, and crashes.
  EXPECT_EQ(nearestTo(ours, *source, 1), nearestTo(pcls, *source, 1));
  pcls.setInputCloud(nowhere);
  ours.setInputCloud(nowhere);
  for (const int k : {1, 5})
    EXPECT_EQ(nearestTo(ours, *source, k), nearestTo(pcls, *source, k));
  expectPclsAnswersAfter([&](Tree& tree) {
    tree.setInputCloud(nowhere);
    tree.setInputCloud(target);
  });
}

TEST_F(SeededKdTreeTest, LeavesOutPointsThatAreNotFinite)
{
  for (std::size_t i = 3; i < target->size(); i += 10)
    (*target)[i].y = std::nanf("");
  expectPclsAnswersAfter([this](Tree& tree) { tree.setInputCloud(target); });
}

TEST_F(SeededKdTreeTest, TakesIndices)
{
  const IndicesPtr half = everyNth(0, 900, 2);
  expectPclsAnswersAfter([&](Tree& tree) { tree.setInputCloud(target, half); });
  expectPclsAnswersAfter([&](Tree& tree) {
    tree.setInputCloud(target);
    tree.setInputCloud(target, half);
  });
  expectPclsAnswersAfter([&](Tree& tree) {
    tree.setInputCloud(target, half);
    tree.setInputCloud(target);
  });
}

TEST_F(SeededKdTreeTest, TakesPointRepresentationsBeforeAndAfterTheCloud)
{
  const auto stretched = pcl::make_shared<TenfoldHeights>();
  expectPclsAnswersAfter([&](Tree& tree) {
    tree.setPointRepresentation(stretched);
    tree.setInputCloud(target);
  });
  expectPclsAnswersAfter([&](Tree& tree) {
    tree.setInputCloud(target);
    tree.setPointRepresentation(stretched);
  });
  expectPclsAnswersAfter([&](Tree& tree) {
    tree.setInputCloud(target);
    tree.setPointRepresentation(stretched);
    tree.setPointRepresentation(
        pcl::make_shared<DefaultPointRepresentation<PointXYZ>>());
  });
}

TEST_F(SeededKdTreeTest, TakesTheOrderOfItsResultsAndEpsilon)
{
  expectPclsAnswersAfter([this](Tree& tree) {
    tree.setSortedResults(false);
    tree.setInputCloud(target);
  });
  expectPclsAnswersAfter([this](Tree& tree) {
    tree.setInputCloud(target);
    tree.setSortedResults(false);
  });
  // An epsilon that is too small to change an answer.
  expectPclsAnswersAfter([this](Tree& tree) {
    tree.setInputCloud(target);
    tree.setEpsilon(1e-9f);
  });
  expectPclsAnswersAfter([this](Tree& tree) {
    tree.setEpsilon(1e-9f);
    tree.setInputCloud(target);
    tree.setEpsilon(1e-9f);
    tree.setInputCloud(target);
  });
}

TEST_F(SeededKdTreeTest, HasThePointsAsTheyWereWhenTheyWereGiven)
{
  for (const int num_times_given : {1, 2}) {
    const auto answersOf = [&](Tree&& tree) {
      const Cloud::Ptr cloud(new Cloud(*target));
      for (int i = 0; i < num_times_given; ++i) {
        tree.setInputCloud(cloud);
        for (auto& point : *cloud)
          point.x += 0.1f;
      }
      return (std::vector<Answer>{nearestTo(tree, *source, 1)[0],
                                  nearestTo(tree, *source, 7)[0],
                                  withinRadius(tree, *source)[0]});
    };
    EXPECT_EQ(answersOf(Seeded()), answersOf(Tree()));
  }
}

TEST_F(SeededKdTreeTest, IsNotBuiltAgainForTheSamePoints)
{
  Seeded tree;
  tree.setInputCloud(target);
  const auto* first = tree.seeded->get().get();
  ASSERT_NE(first, nullptr);
  tree.setInputCloud(target);
  EXPECT_EQ(tree.seeded->get().get(), first);
  const Cloud::Ptr copy(new Cloud(*target));
  tree.setInputCloud(copy);
  EXPECT_EQ(tree.seeded->get().get(), first);
  EXPECT_EQ(tree.getInputCloud(), copy);
  (*copy)[5].z = std::nextafter((*copy)[5].z, 1.0f);
  const auto kept = tree.seeded->get(); // so that no other has its address
  tree.setInputCloud(copy);
  EXPECT_NE(tree.seeded->get(), kept);
}

/** Query, match and squared distance of each pair. */
std::vector<std::tuple<index_t, index_t, float>>
pairsOf(Estimation& estimation, const Cloud::Ptr& source, double max_distance)
{
  estimation.setInputSource(source);
  Correspondences found;
  estimation.determineCorrespondences(found, max_distance);
  std::vector<std::tuple<index_t, index_t, float>> pairs;
  for (const auto& pair : found)
    pairs.emplace_back(pair.index_query, pair.index_match, pair.distance);
  return (pairs);
}

TEST_F(SeededKdTreeTest, ItsEstimationFindsPclsPairs)
{
  // So many points that there is work for three threads; some are equally near.
  const Cloud::Ptr many(new Cloud);
  while (many->size() < 12288)
    *many += *source;
  const Cloud::Ptr few(new Cloud(*many));
  few->resize(100);
  const Cloud::Ptr repeated(new Cloud(*target + *target));
  for (const double max_distance :
       {std::sqrt(std::numeric_limits<double>::max()), 0.01})
    for (const int num_threads : {1, 3}) {
      Estimation pcls;
      bayesian_icp_detail::SeededEstimation<PointXYZ, PointXYZ, float> ours;
      ours.num_threads = num_threads;
      ours.setSearchMethodTarget(pcl::make_shared<Seeded>());
      for (const auto& cloud : {target, repeated, few}) {
        pcls.setInputTarget(cloud);
        ours.setInputTarget(cloud);
        for (const auto& moved : {many, few, many}) {
          for (auto& point : *moved)
            point.x += 0.005f;
          EXPECT_EQ(pairsOf(ours, moved, max_distance),
                    pairsOf(pcls, moved, max_distance));
        }
      }
    }
}

TEST_F(SeededKdTreeTest, ItsEstimationFindsPclsPairsInOtherTreesAndAmongIndices)
{
  constexpr double no_gate = std::numeric_limits<double>::max();
  const auto expectPairs = [&](const auto& prepare, bool has_pcls_tree) {
    Estimation pcls;
    bayesian_icp_detail::SeededEstimation<PointXYZ, PointXYZ, float> ours;
    if (!has_pcls_tree)
      ours.setSearchMethodTarget(pcl::make_shared<Seeded>());
    for (Estimation* estimation : {&pcls, static_cast<Estimation*>(&ours)}) {
      estimation->setInputTarget(target);
      prepare(*estimation);
    }
    EXPECT_EQ(pairsOf(ours, source, no_gate), pairsOf(pcls, source, no_gate));
    const auto copy = ours.clone();
    Correspondences of_copy, of_ours;
    copy->determineCorrespondences(of_copy, no_gate);
    ours.determineCorrespondences(of_ours, no_gate);
    EXPECT_EQ(of_copy.size(), of_ours.size());
  };
  const auto some = pcl::make_shared<Indices>(Indices{5, 3, 3, 8, 5, 0});
  expectPairs([](Estimation&) {}, true);
  expectPairs([&](Estimation& e) { e.setIndicesTarget(some); }, false);
  expectPairs([&](Estimation& e) { e.setIndicesSource(some); }, false);
}

TEST_F(SeededKdTreeTest, AnswersSeveralThreadsAtOnce)
{
  Tree pcls;
  Seeded ours;
  pcls.setInputCloud(target);
  ours.setInputCloud(target);
  std::vector<Answer> nearest[4], within[4];
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&, i] {
      nearest[i] = nearestTo(ours, *source, 1);
      within[i] = withinRadius(ours, *source); // which builds PCL's tree
    });
  for (auto& thread : threads)
    thread.join();
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(nearest[i], nearestTo(pcls, *source, 1));
    EXPECT_EQ(within[i], withinRadius(pcls, *source));
  }
}

using RegistrationTree = ScansTest;

TEST_F(RegistrationTree, IsOurs)
{
  BayesianIcp icp;
  usePaper(icp);
  align(icp);
  const auto ours = dynamic_cast<const Seeded*>(icp.getSearchMethodTarget().get());
  ASSERT_NE(ours, nullptr);
  ASSERT_NE(ours->seeded->get(), nullptr);
  Tree pcls;
  pcls.setInputCloud(scans.target);
  EXPECT_EQ(withinRadius(*ours, output), withinRadius(pcls, output));
}

TEST_F(RegistrationTree, MayBeReadyForOtherRegistrations)
{
  BayesianIcp owner;
  usePaper(owner);
  align(owner);
  for (const bool is_ready : {true, false}) {
    BayesianIcp other;
    usePaper(other);
    other.setInputTarget(scans.target);
    other.setSearchMethodTarget(owner.getSearchMethodTarget(), is_ready);
    align(other);
    EXPECT_EQ(other.getSamples(), owner.getSamples());
    EXPECT_EQ(other.getFinalTransformation(), owner.getFinalTransformation());
  }
}

} // namespace
} // namespace pcl::test
