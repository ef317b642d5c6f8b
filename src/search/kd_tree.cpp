#include "search/kd_tree_build.h"
#include "threads/for_each_piece.h"

#include <bayesian_icp/kd_tree.h>

#include <algorithm>
#include <atomic>
#include <future>
#include <limits>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

namespace bayesian_icp {

const kd_tree::Searches&
kd_tree::searchesOf(InstructionSet instruction_set)
{
  const auto supported = supportedInstructionSets();
  if (std::find(supported.begin(), supported.end(), instruction_set) == supported.end())
    throw std::invalid_argument("KdTree: instruction set not supported");
  switch (instruction_set) {
#if defined(BAYESIAN_ICP_X86_KERNELS)
  case InstructionSet::Sse2:
    return sse2_searches;
  case InstructionSet::Avx2:
    return avx2_searches;
#endif
  default:
    return plain_searches;
  }
}

namespace {

/** Queries of a block, and queries that are worth a thread. */
constexpr std::size_t block_size = 1024, queries_of_thread = 4096;

} // namespace

// For users who compile as C++14, where a static member is no inline variable.
constexpr std::uint32_t KdTree::none;

KdTree::KdTree(Eigen::Matrix3Xf points, int num_threads)
: KdTree(std::move(points), num_threads, supportedInstructionSets().back())
{}

KdTree::KdTree(Eigen::Matrix3Xf points, int num_threads, InstructionSet instruction_set)
: points_(std::move(points))
{
  const auto num_points = static_cast<std::size_t>(points_.cols());
  if (num_points >= none)
    throw std::invalid_argument("KdTree: too many points");
  auto tree = std::make_unique<Tree>();
  tree->searches = kd_tree::searchesOf(instruction_set);
  tree->storage = kd_tree::build(points_.data(), num_points, num_threads);
  tree->view = tree->storage.view();
  tree_ = std::move(tree);
}

KdTree::~KdTree() = default;
KdTree::KdTree(KdTree&&) noexcept = default;
KdTree&
KdTree::operator=(KdTree&&) noexcept = default;

KdTree::Neighbor
KdTree::nearest(const Eigen::Vector3f& query,
                float max_squared_distance,
                std::uint32_t hint) const
{
  // Places without a point are infinitely far: a finite gate keeps them out.
  constexpr float max_float = std::numeric_limits<float>::max();
  kd_tree::Best best{
      std::min(max_squared_distance, max_float), kd_tree::no_point, false};
  if (query.allFinite())
    tree_->searches.nearest(tree_->view, query.data(), hint, best);
  if (best.index == kd_tree::no_point)
    return {none, std::numeric_limits<float>::infinity(), false};
  return {best.index, best.squared_distance, best.is_tied};
}

std::size_t
KdTree::size() const
{
  return tree_->storage.num_points;
}

std::size_t
KdTree::numBytes() const
{
  const kd_tree::Storage& storage = tree_->storage;
  return sizeof(Tree) + storage.nodes.size() * sizeof(kd_tree::Node) +
         storage.cells.size() * sizeof(kd_tree::Cell) +
         storage.leaves.size() * sizeof(kd_tree::Leaf) +
         storage.leaf_of.size() * sizeof(std::uint32_t);
}

void
searchInBlocks(std::size_t count,
               int num_threads,
               const std::function<void(std::size_t, std::size_t)>& search)
{
  std::atomic<std::size_t> next{0};
  FirstException failure;
  const auto work = [&] {
    for (std::size_t begin = next.fetch_add(block_size); begin < count;
         begin = next.fetch_add(block_size))
      if (!failure.guard([&] { search(begin, std::min(begin + block_size, count)); }))
        return;
  };
  std::vector<std::future<void>> others;
  const int num_wanted = numThreadsFor(
      num_threads, static_cast<std::ptrdiff_t>(count / queries_of_thread));
  try {
    while (static_cast<int>(others.size()) + 1 < num_wanted)
      others.push_back(std::async(std::launch::async, work));
  }
  catch (const std::system_error&) {
    // No more threads are to be had.
  }
  work();
  for (auto& other : others)
    other.get();
  failure.rethrow();
}

} // namespace bayesian_icp
