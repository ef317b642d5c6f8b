// Nearest neighbours of one scan in another, neighbourhoods of a scan, and building:
// bayesian_icp::KdTree against pcl::KdTreeFLANN and nanoflann. All names end in the
// number of target points; `time_per_query` is CPU time. Seeded searches begin at the
// last neighbour; nanoflann is told how far away it is.
//
//   kd_tree_benchmark [target.pcd] [Google Benchmark options]
//
// Without a file the target is a simulated scan of a table in four sizes.
#include "benchmark_clouds.h"
#include "search/point_neighbors.h"
#include "simulator/simulation.h"

#include <bayesian_icp/kd_tree.h>

#include <pcl/kdtree/kdtree_flann.h>

#include <Eigen/Geometry>

#include <benchmark/benchmark.h>
#include <nanoflann.hpp>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <random>
#include <string>
#include <vector>

namespace {

using bayesian_icp::InstructionSet;
using bayesian_icp::KdTree;
namespace simulator = bayesian_icp::simulator;

/** Points to find neighbours of, and for each the neighbour that it had at a pose
 * nearby: what a sampler knows from its last visit. */
struct Queries {
  Eigen::Matrix3Xf points;
  std::vector<std::uint32_t> last_neighbors;
};

struct Scene {
  Eigen::Matrix3Xf target;
  Queries scan_order;
  Queries random_order;
};

Queries
shuffled(const Queries& queries)
{
  std::vector<Eigen::Index> order(queries.last_neighbors.size());
  std::iota(order.begin(), order.end(), Eigen::Index(0));
  std::shuffle(order.begin(), order.end(), std::mt19937(2));
  Queries result{queries.points(Eigen::all, order), {}};
  for (const Eigen::Index i : order)
    result.last_neighbors.push_back(
        queries.last_neighbors[static_cast<std::size_t>(i)]);
  return result;
}

/** Up to 50 000 queries: points of the target, moved by a pose 7 mm and 0.01 rad off.
 * The last visit was at a pose that differs from it by another 2 mm and 0.003 rad. */
Scene
makeScene(const Eigen::Matrix3Xf& target)
{
  const Eigen::Index step = std::max<Eigen::Index>(target.cols() / 50000, 1);
  Eigen::Matrix3Xf source(3, target.cols() / step);
  for (Eigen::Index i = 0; i < source.cols(); ++i)
    source.col(i) = target.col(i * step);
  const auto pose = [](float distance, float angle) {
    const Eigen::Vector3f axis = Eigen::Vector3f(1.f, -2.f, 3.f).normalized();
    return Eigen::Translation3f(0.f, 0.6f * distance, 0.8f * distance) *
           Eigen::AngleAxisf(angle, axis);
  };
  Queries queries{pose(0.007f, 0.01f) * source, {}};
  const Eigen::Matrix3Xf last_visit = pose(0.009f, 0.013f) * source;
  const KdTree tree(target);
  for (Eigen::Index i = 0; i < last_visit.cols(); ++i)
    queries.last_neighbors.push_back(
        tree.nearest(last_visit.col(i), std::numeric_limits<float>::infinity()).index);
  return {target, queries, shuffled(queries)};
}

// The trees behind one interface: made of points, build() again, nearest(query, last
// neighbour), and nearestK(query, k), which returns the index of the last of them.

class FlannTree {
public:
  explicit FlannTree(const Eigen::Matrix3Xf& points) : cloud_(cloudOf(points))
  {
    build();
  }

  void
  build()
  {
    tree_.setInputCloud(cloud_);
  }

  int
  nearest(const Eigen::Vector3f& query, std::uint32_t)
  {
    tree_.nearestKSearch({query.x(), query.y(), query.z()}, 1, index_, distance_);
    return index_[0];
  }

  int
  nearestK(const Eigen::Vector3f& query, int k)
  {
    tree_.nearestKSearch({query.x(), query.y(), query.z()}, k, index_, distance_);
    return index_.back();
  }

private:
  Cloud::Ptr cloud_;
  pcl::KdTreeFLANN<pcl::PointXYZ> tree_;
  pcl::Indices index_ = pcl::Indices(1);
  std::vector<float> distance_ = std::vector<float>(1);
};

/** What nanoflann wants to know about a cloud. */
struct NanoflannCloud {
  const Eigen::Matrix3Xf& points;

  std::size_t
  kdtree_get_point_count() const
  {
    return static_cast<std::size_t>(points.cols());
  }
  float
  kdtree_get_pt(std::size_t index, std::size_t axis) const
  {
    return points(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(index));
  }
  template <typename Box>
  bool
  kdtree_get_bbox(Box&) const
  {
    return false;
  }
};

using NanoflannIndex = nanoflann::KDTreeSingleIndexAdaptor<
    nanoflann::L2_Simple_Adaptor<float, NanoflannCloud>,
    NanoflannCloud,
    3,
    std::uint32_t>;

class NanoflannTree {
public:
  explicit NanoflannTree(const Eigen::Matrix3Xf& points, bool is_seeded = false)
  : cloud_{points}
  , tree_(3, cloud_, {10})
  , is_seeded_(is_seeded)
  {
    build();
  }

  void
  build()
  {
    tree_.buildIndex();
  }

  std::uint32_t
  nearest(const Eigen::Vector3f& query, std::uint32_t last_neighbor) const
  {
    std::uint32_t index = 0;
    float squared_distance = 0.0f;
    nanoflann::KNNResultSet<float, std::uint32_t> result(1);
    result.init(&index, &squared_distance); // which is the largest number then
    if (is_seeded_) {
      index = last_neighbor;
      squared_distance = (cloud_.points.col(last_neighbor) - query).squaredNorm();
    }
    tree_.findNeighbors(result, query.data(), {});
    return index;
  }

  std::uint32_t
  nearestK(const Eigen::Vector3f& query, int k)
  {
    const auto count = static_cast<std::size_t>(k);
    indices_.resize(count);
    squared_distances_.resize(count);
    tree_.knnSearch(query.data(), count, indices_.data(), squared_distances_.data());
    return indices_.back();
  }

private:
  NanoflannCloud cloud_;
  NanoflannIndex tree_;
  bool is_seeded_;
  std::vector<std::uint32_t> indices_;
  std::vector<float> squared_distances_;
};

class OwnTree {
public:
  OwnTree(const Eigen::Matrix3Xf& points,
          bool is_seeded,
          InstructionSet instruction_set)
  : tree_(points, 0, instruction_set)
  , is_seeded_(is_seeded)
  {}

  std::uint32_t
  nearest(const Eigen::Vector3f& query, std::uint32_t last_neighbor) const
  {
    const std::uint32_t hint = is_seeded_ ? last_neighbor : KdTree::none;
    return tree_.nearest(query, std::numeric_limits<float>::infinity(), hint).index;
  }

private:
  KdTree tree_;
  bool is_seeded_;
};

class OwnNeighbors {
public:
  explicit OwnNeighbors(const Eigen::Matrix3Xf& points) : neighbors_(points) {}

  std::uint32_t
  nearestK(const Eigen::Vector3f& query, int k)
  {
    neighbors_.find(query, static_cast<std::size_t>(k), list_);
    return list_.indices.back();
  }

private:
  bayesian_icp::PointNeighbors neighbors_;
  bayesian_icp::NeighborList list_;
};

void
countQueries(benchmark::State& state, Eigen::Index num_queries)
{
  state.counters["time_per_query"] = benchmark::Counter(
      static_cast<double>(num_queries),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

template <typename Tree>
void
runQueries(benchmark::State& state, Tree tree, const Queries& queries)
{
  const auto num_queries = queries.points.cols();
  for (auto _ : state)
    for (Eigen::Index i = 0; i < num_queries; ++i)
      benchmark::DoNotOptimize(tree.nearest(
          queries.points.col(i), queries.last_neighbors[static_cast<std::size_t>(i)]));
  countQueries(state, num_queries);
}

const char*
nameOf(InstructionSet instruction_set)
{
  constexpr const char* names[] = {"plain", "sse2", "avx2"};
  return names[static_cast<int>(instruction_set)];
}

template <typename Function>
void
add(const std::string& name, std::size_t num_points, Function function)
{
  benchmark::RegisterBenchmark((name + "/" + std::to_string(num_points)).c_str(),
                               function)
      ->MeasureProcessCPUTime()
      ->Unit(benchmark::kMillisecond);
}

void
addQueries(const std::string& order, const Queries& queries, const Scene& scene)
{
  const auto size = static_cast<std::size_t>(scene.target.cols());
  add(order + "/flann", size, [&](benchmark::State& state) {
    runQueries(state, FlannTree(scene.target), queries);
  });
  for (const bool is_seeded : {false, true})
    add(order + (is_seeded ? "/nanoflann_seeded" : "/nanoflann"),
        size,
        [&queries, &scene, is_seeded](benchmark::State& state) {
          runQueries<const NanoflannTree&>(
              state, NanoflannTree(scene.target, is_seeded), queries);
        });
  for (const bool is_seeded : {false, true})
    for (const auto set : bayesian_icp::supportedInstructionSets())
      add(order + (is_seeded ? "/seeded/" : "/own/") + nameOf(set),
          size,
          [&queries, &scene, is_seeded, set](benchmark::State& state) {
            runQueries<const OwnTree&>(
                state, OwnTree(scene.target, is_seeded, set), queries);
          });
}

/** Neighbourhoods of all points, as preset `calibrated` asks for them: of 45 points, in
 * an order in which most are near the one before. */
template <typename Tree>
void
addNeighborhoods(const std::string& name, const Scene& scene)
{
  add("neighborhoods/" + name,
      static_cast<std::size_t>(scene.target.cols()),
      [&scene](benchmark::State& state) {
        const auto order = bayesian_icp::PointNeighbors(scene.target).alongTree();
        Tree tree(scene.target);
        for (auto _ : state)
          for (const std::uint32_t point : order)
            benchmark::DoNotOptimize(tree.nearestK(scene.target.col(point), 45));
        countQueries(state, scene.target.cols());
      });
}

void
addBuilding(const Scene& scene)
{
  const auto size = static_cast<std::size_t>(scene.target.cols());
  add("build/flann", size, [&scene](benchmark::State& state) {
    FlannTree tree(scene.target);
    for (auto _ : state)
      tree.build();
  });
  add("build/nanoflann", size, [&scene](benchmark::State& state) {
    NanoflannTree tree(scene.target);
    for (auto _ : state)
      tree.build();
  });
  for (const int num_threads : {1, 2})
    add("build/own/threads:" + std::to_string(num_threads),
        size,
        [&scene, num_threads](benchmark::State& state) {
          for (auto _ : state)
            benchmark::DoNotOptimize(KdTree(scene.target, num_threads).size());
        });
}

/** A depth camera 1.4 m from a table with things on it. */
Eigen::Matrix3Xf
scanOfTable(int width)
{
  simulator::SensorOptions sensor;
  sensor.camera.width = width;
  sensor.camera.height = width * 3 / 4;
  const simulator::View view = {{0.0, -1.2, 0.7}, {0.0, 0.0, 0.0}};
  return simulator::scanScene(simulator::makeScene("table"),
                              sensor,
                              simulator::sensorPose(sensor.kind, view),
                              1,
                              0)
      .points.cast<float>();
}

std::vector<Scene>
scenes(int argc, char** argv)
{
  std::vector<Scene> scenes;
  if (argc > 1) {
    scenes.push_back(makeScene(pointsOf(*readCloud(argv[1]))));
    return scenes;
  }
  for (const int width : {144, 460, 1000, 2280})
    scenes.push_back(makeScene(scanOfTable(width)));
  return scenes;
}

} // namespace

int
main(int argc, char** argv)
{
  benchmark::Initialize(&argc, argv);
  const std::vector<Scene> all_scenes = scenes(argc, argv);
  for (const Scene& scene : all_scenes) {
    addQueries("scan_order", scene.scan_order, scene);
    addQueries("random_order", scene.random_order, scene);
    addNeighborhoods<FlannTree>("flann", scene);
    addNeighborhoods<NanoflannTree>("nanoflann", scene);
    addNeighborhoods<OwnNeighbors>("own", scene);
    addBuilding(scene);
  }
  benchmark::RunSpecifiedBenchmarks();
  return all_scenes.empty() ? 1 : 0;
}
