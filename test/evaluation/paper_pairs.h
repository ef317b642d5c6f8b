/** \file
 * \brief Small pairs of scans on disk, for the tests of the paper's experiments.
 */
#pragma once

#include <bayesian_icp/random.h>

#include <Eigen/Geometry>

#include <filesystem>
#include <fstream>
#include <string>

/** \brief 3 x n points of a bumpy, bounded surface: every motion changes distances. */
inline Eigen::Matrix3Xd
bumpySurface(Eigen::Index size, std::uint64_t seed)
{
  bayesian_icp::Random random(seed, 0);
  Eigen::Matrix3Xd points(3, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const double x = 0.2 * random.uniform() - 0.1, y = 0.3 * random.uniform() - 0.15;
    points.col(i) << x, y, 0.03 * std::sin(40.0 * x) + 0.02 * std::cos(30.0 * y);
  }
  return points;
}

/** \brief Write a cloud as an ASCII PCD file with all digits. */
inline void
writeCloud(const std::filesystem::path& file, const Eigen::Matrix3Xd& points)
{
  std::ofstream stream(file);
  stream.precision(9);
  stream << "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH "
         << points.cols() << "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS "
         << points.cols() << "\nDATA ascii\n"
         << points.transpose() << '\n';
}

inline void
writeMatrix(const std::filesystem::path& file, const Eigen::Isometry3d& transform)
{
  std::ofstream stream(file);
  stream.precision(17);
  stream << transform.matrix() << '\n';
}

/** \brief Write FOLDER/NAME in the layout of data/, and return the true motion. */
inline Eigen::Isometry3d
writeScanPair(const std::filesystem::path& folder, const std::string& name)
{
  std::filesystem::create_directories(folder / name);
  Eigen::Isometry3d truth = Eigen::Isometry3d::Identity();
  truth.translate(Eigen::Vector3d(0.01, -0.02, 0.005));
  truth.rotate(Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitZ()));
  const Eigen::Matrix3Xd target = bumpySurface(300, 1);
  writeCloud(folder / name / "source.pcd", truth.inverse() * bumpySurface(200, 2));
  writeCloud(folder / name / "target.pcd", target);
  writeMatrix(folder / name / "T_target_source.txt", truth);
  return truth;
}
