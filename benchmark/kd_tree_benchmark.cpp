// Nearest neighbours of one scan in another: bayesian_icp::KdTree against
// pcl::KdTreeFLANN and nanoflann, queries and building. All names end in the number of
// target points; `time_per_query` is CPU time.
//
//   kd_tree_benchmark [target.pcd] [Google Benchmark options]
//
// Without a file the target is a simulated scan of a table in four sizes.
#include "kd_tree_benchmark_data.h"

#include <bayesian_icp/kd_tree.h>

#include <pcl/io/pcd_io.h>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>

#include <benchmark/benchmark.h>
#include <nanoflann.hpp>

#include <limits>
#include <memory>
#include <string>

namespace {

using bayesian_icp::InstructionSet;
using bayesian_icp::KdTree;

constexpr float no_gate = std::numeric_limits<float>::infinity();

class FlannTree {
public:
  explicit FlannTree(const Eigen::Matrix3Xf& points)
  : cloud_(new pcl::PointCloud<pcl::PointXYZ>)
  {
    for (Eigen::Index i = 0; i < points.cols(); ++i)
      cloud_->emplace_back(points(0, i), points(1, i), points(2, i));
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

private:
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud_;
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
  explicit NanoflannTree(const Eigen::Matrix3Xf& points)
  : cloud_{points}
  , tree_(3, cloud_, {10})
  {
    build();
  }

  void
  build()
  {
    tree_.buildIndex();
  }

  std::uint32_t
  nearest(const Eigen::Vector3f& query, std::uint32_t) const
  {
    std::uint32_t index = 0;
    float squared_distance = 0.f;
    tree_.knnSearch(query.data(), 1, &index, &squared_distance);
    return index;
  }

private:
  NanoflannCloud cloud_;
  NanoflannIndex tree_;
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
    return tree_.nearest(query, no_gate, hint).index;
  }

private:
  KdTree tree_;
  bool is_seeded_;
};

template <typename Tree>
void
runQueries(benchmark::State& state, Tree tree, const Queries& queries)
{
  const auto num_queries = queries.points.cols();
  for (auto _ : state)
    for (Eigen::Index i = 0; i < num_queries; ++i)
      benchmark::DoNotOptimize(tree.nearest(
          queries.points.col(i), queries.last_neighbors[static_cast<std::size_t>(i)]));
  state.counters["time_per_query"] = benchmark::Counter(
      static_cast<double>(num_queries),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

const char*
nameOf(InstructionSet instruction_set)
{
  constexpr const char* names[] = {"plain", "sse2", "avx2", "avx512"};
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
  add(order + "/nanoflann", size, [&](benchmark::State& state) {
    runQueries<const NanoflannTree&>(state, NanoflannTree(scene.target), queries);
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

std::vector<Scene>
scenes(int argc, char** argv)
{
  std::vector<Scene> scenes;
  if (argc > 1) {
    pcl::PointCloud<pcl::PointXYZ> cloud;
    if (pcl::io::loadPCDFile(argv[1], cloud) == 0)
      scenes.push_back(makeScene(cloud.getMatrixXfMap().topRows<3>()));
    return scenes;
  }
  for (const int width : {86, 276, 599, 1366})
    scenes.push_back(makeScene(scanOfTable(width, width * 3 / 4)));
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
    addBuilding(scene);
  }
  benchmark::RunSpecifiedBenchmarks();
  return all_scenes.empty() ? 1 : 0;
}
