#include "graph/graph_file.h"

#include "io/errors.h"
#include "io/input_file.h"
#include "io/numbers.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <stdexcept>

namespace bayesian_icp::app {

namespace {

constexpr std::uint64_t max_size = 1'000'000'000;
constexpr const char* edge_tag = "EDGE_SE3:QUAT";
constexpr double quaternion_tolerance = 1e-2;

/** Numbers of a line, one after the other. */
class Numbers {
public:
  explicit Numbers(const std::vector<std::string_view>& words) : words_(words) {}

  template <typename Number>
  void
  read(Number& number)
  {
    if (next_ == words_.size() || !io::readNumber(words_[next_++], number))
      throw std::runtime_error("is not an edge of two vertices, 7 numbers of its pose "
                               "and 21 of its information");
  }

  bool
  areAllRead() const
  {
    return next_ == words_.size();
  }

private:
  const std::vector<std::string_view>& words_;
  std::size_t next_ = 1; // behind the tag
};

Eigen::Matrix4d
readPose(Numbers& numbers)
{
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  for (int k = 0; k < 3; ++k)
    numbers.read(T(k, 3));
  Eigen::Quaterniond rotation;
  for (const int k : {0, 1, 2, 3})
    numbers.read(rotation.coeffs()[k]);
  if (!(std::abs(rotation.norm() - 1.0) < quaternion_tolerance) || !T.allFinite())
    throw std::runtime_error("has a pose that is none");
  T.topLeftCorner<3, 3>() = rotation.normalized().toRotationMatrix();
  return T;
}

Matrix6d
readCovariance(Numbers& numbers)
{
  Matrix6d information;
  for (int row = 0; row < 6; ++row)
    for (int column = row; column < 6; ++column) {
      numbers.read(information(row, column));
      information(column, row) = information(row, column);
    }
  const Eigen::LLT<Matrix6d> factor(information);
  const Matrix6d of_half_angles = factor.solve(Matrix6d::Identity());
  if (factor.info() != Eigen::Success || !of_half_angles.allFinite())
    throw std::runtime_error("has an information that is not positive definite");
  Vector6d scale;
  scale << 1.0, 1.0, 1.0, 2.0, 2.0, 2.0;
  return scale.asDiagonal() * of_half_angles * scale.asDiagonal();
}

GraphEdge
edgeOf(const std::vector<std::string_view>& words)
{
  Numbers numbers(words);
  GraphEdge edge;
  numbers.read(edge.target);
  numbers.read(edge.source);
  edge.T_target_source = readPose(numbers);
  edge.covariance = readCovariance(numbers);
  if (!numbers.areAllRead() || edge.target == edge.source)
    throw std::runtime_error("has too many numbers, or joins a vertex to itself");
  return edge;
}

} // namespace

std::vector<GraphEdge>
readGraph(const std::string& file)
{
  const std::string text = io::readText(file, max_size);
  std::vector<GraphEdge> edges;
  int line_number = 0;
  for (const std::string_view line : io::splitAt('\n', text)) {
    ++line_number;
    const std::vector<std::string_view> words = io::words(line);
    if (words.empty() || words[0] != edge_tag)
      continue;
    try {
      edges.push_back(edgeOf(words));
    }
    catch (const std::runtime_error& error) {
      throw io::FileError(file, "line " + io::textOf(line_number) + ' ' + error.what());
    }
  }
  if (edges.empty())
    throw io::FileError(file, std::string("has no ") + edge_tag);
  return edges;
}

} // namespace bayesian_icp::app
