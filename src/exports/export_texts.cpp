#include <bayesian_icp/exports.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <charconv>
#include <stdexcept>

namespace bayesian_icp {

namespace {

constexpr std::int64_t nanoseconds_per_second = 1'000'000'000;

/** A number that reads back without loss. YAML 1.1 takes "1e-05" for a word, but not
 * "1.0e-05". */
std::string
textOf(double number)
{
  char buffer[64];
  const auto result = std::to_chars(buffer, buffer + sizeof(buffer), number);
  std::string text(buffer, result.ptr);
  if (text.find('.') == std::string::npos)
    text.insert(std::min(text.find('e'), text.size()), ".0");
  return text;
}

template <typename Derived>
std::string
rowsOf(const Eigen::MatrixBase<Derived>& matrix)
{
  std::string text;
  for (Eigen::Index row = 0; row < matrix.rows(); ++row)
    for (Eigen::Index column = 0; column < matrix.cols(); ++column)
      text += textOf(matrix(row, column)) + (column + 1 < matrix.cols() ? ' ' : '\n');
  return text;
}

/** Unit quaternion with w >= 0. */
Eigen::Quaterniond
quaternionOf(const Eigen::Matrix3d& rotation)
{
  Eigen::Quaterniond q(rotation);
  q.normalize();
  if (q.w() < 0.0)
    q.coeffs() *= -1.0;
  return q;
}

/** "x y z qx qy qz qw". */
std::string
poseText(const Eigen::Matrix4d& matrix)
{
  const Eigen::Quaterniond q = quaternionOf(matrix.topLeftCorner<3, 3>());
  std::string text;
  for (int k = 0; k < 3; ++k)
    text += textOf(matrix(k, 3)) + ' ';
  return text + textOf(q.x()) + ' ' + textOf(q.y()) + ' ' + textOf(q.z()) + ' ' +
         textOf(q.w());
}

void
require(const PoseEstimate& estimate,
        bool needs_information,
        const ExportOptions& options)
{
  std::string complaint = options.validate();
  if (complaint.empty())
    complaint =
        complaintAboutExport(estimate, needs_information, options.accept_unreliable);
  if (!complaint.empty())
    throw std::invalid_argument(complaint);
}

/** A timestamp in seconds with nine decimals. */
std::string
secondsOf(std::int64_t timestamp_ns)
{
  const std::string decimals = std::to_string(timestamp_ns % nanoseconds_per_second);
  return std::to_string(timestamp_ns / nanoseconds_per_second) + '.' +
         std::string(9 - decimals.size(), '0') + decimals;
}

/** "x: ...", "y: ...", one line each. */
std::string
yamlFields(const Eigen::Ref<const Eigen::VectorXd>& values)
{
  const char* const names[] = {"x", "y", "z", "w"};
  std::string text;
  for (Eigen::Index k = 0; k < values.size(); ++k)
    text += std::string("      ") + names[k] + ": " + textOf(values[k]) + '\n';
  return text;
}

} // namespace

Matrix6d
g2oCovariance(const Matrix6d& right_se3)
{
  Vector6d half_angles;
  half_angles << 1.0, 1.0, 1.0, 0.5, 0.5, 0.5;
  return half_angles.asDiagonal() * right_se3 * half_angles.asDiagonal();
}

Matrix6d
gtsamCovariance(const Matrix6d& right_se3)
{
  Matrix6d rotation_first;
  rotation_first << right_se3.bottomRightCorner<3, 3>(),
      right_se3.bottomLeftCorner<3, 3>(), right_se3.topRightCorner<3, 3>(),
      right_se3.topLeftCorner<3, 3>();
  return rotation_first;
}

std::string
g2oEdge(const PoseEstimate& estimate, const ExportOptions& options)
{
  require(estimate, true, options);
  const Matrix6d information =
      informationOf(g2oCovariance(estimate.covariance(CovarianceConvention::RightSE3)));
  std::string text = "EDGE_SE3:QUAT " + std::to_string(options.target_vertex) + ' ' +
                     std::to_string(options.source_vertex) + ' ' +
                     poseText(matrixOf(estimate.mean));
  for (Eigen::Index row = 0; row < 6; ++row)
    for (Eigen::Index column = row; column < 6; ++column)
      text += ' ' + textOf(information(row, column));
  return text + '\n';
}

std::string
g2oVertex(const Eigen::Matrix4d& pose, int id)
{
  if (id < 0 || !pose.allFinite())
    throw std::invalid_argument("a vertex is negative, or its pose not finite");
  return "VERTEX_SE3:QUAT " + std::to_string(id) + ' ' + poseText(pose) + '\n';
}

std::string
gtsamText(const PoseEstimate& estimate, const ExportOptions& options)
{
  require(estimate, true, options);
  const Matrix6d covariance =
      gtsamCovariance(estimate.covariance(CovarianceConvention::RightSE3));
  return "# T_target_source, translation in m\n" + rowsOf(matrixOf(estimate.mean)) +
         "# covariance, T = T_mean exp(xi), xi = (w_x, w_y, w_z, v_x, v_y, v_z), rad, "
         "m\n" +
         rowsOf(covariance) + "# information, its inverse\n" +
         rowsOf(informationOf(covariance));
}

std::string
rosYaml(const PoseEstimate& estimate, const ExportOptions& options)
{
  require(estimate, false, options);
  const Matrix6d& covariance = estimate.covariance(CovarianceConvention::R3xSO3);
  std::string text = "header:\n  stamp:\n    sec: " +
                     std::to_string(options.timestamp_ns / nanoseconds_per_second) +
                     "\n    nanosec: " +
                     std::to_string(options.timestamp_ns % nanoseconds_per_second) +
                     "\n  frame_id: \"" + options.target_frame +
                     "\"\npose:\n  pose:\n    position:\n" +
                     yamlFields(estimate.mean.head<3>()) + "    orientation:\n" +
                     yamlFields(quaternionOf(rotationOf(estimate.mean)).coeffs()) +
                     "  covariance: [";
  for (Eigen::Index i = 0; i < 36; ++i)
    text += (i == 0       ? ""
             : i % 6 == 0 ? ",\n    "
                          : ", ") +
            textOf(covariance(i / 6, i % 6));
  return text + "]\n";
}

std::string
tumLine(const PoseEstimate& estimate, const ExportOptions& options)
{
  require(estimate, false, options);
  return secondsOf(options.timestamp_ns) + ' ' + poseText(matrixOf(estimate.mean)) +
         '\n';
}

std::string
tumCovarianceLine(const PoseEstimate& estimate, const ExportOptions& options)
{
  require(estimate, false, options);
  std::string text = secondsOf(options.timestamp_ns);
  const Matrix6d& covariance = estimate.covariance(CovarianceConvention::R3xSO3);
  for (Eigen::Index i = 0; i < 36; ++i)
    text += ' ' + textOf(covariance(i / 6, i % 6));
  return text + '\n';
}

std::string
csvText(const PoseEstimate& estimate, const ExportOptions& options)
{
  require(estimate, false, options);
  const std::string names[] = {"x", "y", "z", "roll", "pitch", "yaw"};
  const char* const units[] = {"_rad2", "_m_rad", "_m2"};
  std::string header = "timestamp_s,target_frame,source_frame,status";
  std::string row = secondsOf(options.timestamp_ns) + ',' + options.target_frame + ',' +
                    options.source_frame + ',' + toString(estimate.status);
  for (int k = 0; k < 6; ++k) {
    header += ',' + names[k] + (k < 3 ? "_m" : "_rad");
    row += ',' + textOf(estimate.mean[k]);
  }
  for (int i = 0; i < 6; ++i)
    for (int k = i; k < 6; ++k) {
      header += ",cov_" + names[i] + '_' + names[k] + units[(i < 3) + (k < 3)];
      row += ',' + textOf(estimate.covariance(CovarianceConvention::Parameters)(i, k));
    }
  return header + '\n' + row + '\n';
}

} // namespace bayesian_icp
