#include "io/motion.h"

#include "io/errors.h"
#include "io/input_file.h"
#include "io/numbers.h"
#include "io/posterior_file.h"

#include <Eigen/LU>

#include <filesystem>
#include <system_error>

namespace bayesian_icp::io {

namespace {

/** Matrices printed with four digits are still rotations. */
constexpr double rotation_tolerance = 1e-3;
constexpr std::uint64_t max_matrix_file_size = 1 << 16;

} // namespace

Eigen::Matrix4d
readMatrixFile(const std::string& file)
{
  const std::string text = readText(file, max_matrix_file_size);
  const auto items = words(text, " \t\r\n,;");
  Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix;
  if (items.size() != 16)
    throw FileError(file,
                    "has " + std::to_string(items.size()) +
                        " numbers instead of the 16 of a 4x4 matrix");
  for (std::size_t i = 0; i < 16; ++i)
    if (!readNumber(items[i], matrix.data()[i]))
      throw FileError(file, io::inQuotes(items[i]) + " is not a number");
  const std::string complaint = complaintAboutMotion(matrix);
  if (!complaint.empty())
    throw FileError(file, complaint);
  return matrix;
}

std::string
complaintAboutMotion(const Eigen::Matrix4d& matrix)
{
  if (!matrix.allFinite())
    return "the matrix is not finite";
  if (matrix.row(3) != Eigen::RowVector4d::UnitW())
    return "the last row of the matrix is not 0 0 0 1";
  const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
  if (!(R * R.transpose()).isIdentity(rotation_tolerance) || R.determinant() < 0.0)
    return "the upper left of the matrix is not a rotation";
  return "";
}

Eigen::Matrix4d
readMotionFile(const std::string& file)
{
  if (std::filesystem::path(file).extension() != ".json")
    return readMatrixFile(file);
  const Eigen::Matrix4d mean = matrixOf(readPosterior(file).mean);
  const std::string complaint = complaintAboutMotion(mean);
  if (!complaint.empty())
    throw FileError(file, "posterior.mean: " + complaint);
  return mean;
}

bool
areAnglesWithinATurn(const Vector6d& pose)
{
  return pose.tail<3>().cwiseAbs().maxCoeff() <= 2.0 * M_PI;
}

Eigen::Matrix4d
readMotion(const std::string& option, const std::string& text)
{
  if (Vector6d pose; readNumbers(text, pose)) {
    if (!pose.allFinite())
      throw UsageError("--" + option + ": must be finite");
    if (!areAnglesWithinATurn(pose))
      throw UsageError("--" + option + ": " + io::inQuotes(text) +
                       " has an angle of more than a turn; angles are in radians");
    return matrixOf(pose);
  }
  std::error_code ignored;
  if (text.find(',') != std::string::npos && !std::filesystem::exists(text, ignored))
    throw UsageError("--" + option + ": " + io::inQuotes(text) +
                     " is neither the six numbers x,y,z,roll,pitch,yaw [m, rad], "
                     "without spaces, nor a file");
  return readMotionFile(text);
}

} // namespace bayesian_icp::io
