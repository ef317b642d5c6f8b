/** \file
 * \brief Exact nearest neighbours in a cloud that does not change, for searches that
 * are repeated with almost the same queries.
 */
#pragma once

#include <bayesian_icp/export.h>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace bayesian_icp {

class NeighborCache;

/** \brief The processor instructions that a search uses. All give the same bits. */
enum class InstructionSet { Plain, Sse2, Avx2 };

/** \brief The instruction sets that this build of the library and this processor
 * support, Plain first, the fastest last. */
BAYESIAN_ICP_EXPORT std::vector<InstructionSet>
supportedInstructionSets();

/** \brief Exact search for the nearest of n points.
 *
 * A tree of nodes with up to eight bounding boxes over leaves of 16 points. It is the
 * same tree, and gives the same answers to the last bit, for any number of threads and
 * any instruction set. Distances are taken in single precision,
 * (dx * dx + dy * dy) + dz * dz with d = point - query; clouds far from the origin
 * should be centred by the caller.
 *
 * Memory: the points (12 bytes each), at most 24 bytes per point + 1 kB for the tree,
 * and another 16 bytes per point while it is built. */
class BAYESIAN_ICP_EXPORT KdTree {
public:
  /** \brief The index of no point. */
  static constexpr std::uint32_t none = 0xffffffff;

  struct Neighbor {
    /** Column of points(), or none. */
    std::uint32_t index;
    /** Squared distance to it [m^2]; infinite if there is none. */
    float squared_distance;
    /** Whether another point is exactly as near. */
    bool is_tied;
  };

  /** \brief Build the tree.
   * \param[in] points 3 x n [m], fewer than 2^32 - 1 columns; columns with a non-finite
   *            coordinate are never found
   * \param[in] num_threads largest number of threads, 0 means OpenMP's default; the
   *            tree of a small cloud is built by one
   * \throws std::invalid_argument if there are too many points */
  explicit KdTree(Eigen::Matrix3Xf points, int num_threads = 0);

  /** \brief Build the tree for an instruction set of supportedInstructionSets() instead
   * of the fastest one; otherwise as above.
   * \throws std::invalid_argument also if the instruction set is not supported */
  KdTree(Eigen::Matrix3Xf points, int num_threads, InstructionSet instruction_set);

  ~KdTree();
  KdTree(KdTree&&) noexcept;
  KdTree&
  operator=(KdTree&&) noexcept;

  /** \brief The point nearest to \p query; of equally near points, the one with the
   * smallest index. Several threads may call it at once. It allocates nothing.
   * \param[in] query same frame as the points [m]; none is found for a non-finite one
   * \param[in] max_squared_distance the gate [m^2], inclusive; may be infinite, but a
   *            squared distance that overflows a float is beyond every gate
   * \param[in] hint a point that may be near, such as the last answer to a similar
   *            query: makes the search faster and never changes its answer
   * \return the neighbour; index none if no point is within the gate */
  Neighbor
  nearest(const Eigen::Vector3f& query,
          float max_squared_distance,
          std::uint32_t hint = none) const;

  /** \brief The points given to the constructor, [m]. */
  const Eigen::Matrix3Xf&
  points() const
  {
    return points_;
  }

  /** \brief The number of points in the tree: the columns that are finite. */
  std::size_t
  size() const;

  /** \brief The memory of the tree without that of points() [bytes]. */
  std::size_t
  numBytes() const;

private:
  friend class NeighborCache;
  struct Tree;

  Eigen::Matrix3Xf points_;
  std::unique_ptr<const Tree> tree_;
};

/** \brief Run many queries: call search(begin, end) for blocks of 0 ... count - 1, in
 * any order. Several threads share a large number of queries. They are started for this
 * call, and none of them busy-waits.
 * \param[in] count number of queries
 * \param[in] num_threads 0 means OpenMP's default, and one inside a parallel region
 * \param[in] search may be called by several threads at once; the first exception that
 *            it throws is thrown to the caller */
BAYESIAN_ICP_EXPORT void
searchInBlocks(std::size_t count,
               int num_threads,
               const std::function<void(std::size_t begin, std::size_t end)>& search);

} // namespace bayesian_icp
