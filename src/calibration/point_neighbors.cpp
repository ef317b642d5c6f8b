#include "patch_fit.h"

#include <nanoflann.hpp>

namespace bayesian_icp {

namespace {

/** Of the search tree: the fastest for some tens of neighbours. */
constexpr std::size_t max_leaf_size = 16;

} // namespace

struct PointNeighbors::Index {
  struct Points {
    const Eigen::Matrix3Xf& matrix;

    std::size_t
    kdtree_get_point_count() const
    {
      return static_cast<std::size_t>(matrix.cols());
    }

    float
    kdtree_get_pt(std::size_t point, std::size_t axis) const
    {
      return matrix(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(point));
    }

    template <typename Box>
    bool
    kdtree_get_bbox(Box&) const
    {
      return false;
    }
  };

  explicit Index(const Eigen::Matrix3Xf& points)
  : adaptor{points}
  , tree(3, adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(max_leaf_size))
  {
    tree.buildIndex();
  }

  Points adaptor;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Points>,
                                      Points,
                                      3,
                                      std::uint32_t>
      tree;
};

PointNeighbors::PointNeighbors(const Eigen::Matrix3Xf& points)
: points_(points)
, index_(std::make_unique<const Index>(points))
{}

PointNeighbors::~PointNeighbors() = default;

void
PointNeighbors::find(const Eigen::Vector3f& query,
                     std::size_t count,
                     std::vector<std::uint32_t>& indices,
                     std::vector<float>& squared_distances) const
{
  indices.resize(count);
  squared_distances.resize(count);
  const std::size_t found = index_->tree.knnSearch(
      query.data(), count, indices.data(), squared_distances.data());
  indices.resize(found);
  squared_distances.resize(found);
}

} // namespace bayesian_icp
