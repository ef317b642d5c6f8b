/** \file
 * \brief Clouds of the benchmarks: read from files, thinned or grown to a size.
 */
#pragma once

#include <pcl/common/point_tests.h>
#include <pcl/io/pcd_io.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <Eigen/Core>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <random>
#include <string>
#include <vector>

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

/** End a benchmark whose input is of no use. */
[[noreturn]] inline void
giveUp(const std::string& file)
{
  std::cerr << file << " cannot be read, or is empty\n";
  std::exit(1);
}

/** The finite points of a .pcd file, of which there are some. */
inline Cloud::Ptr
readCloud(const std::string& file)
{
  Cloud all;
  const Cloud::Ptr finite(new Cloud);
  if (pcl::io::loadPCDFile(file, all) < 0)
    giveUp(file);
  for (const auto& point : all)
    if (pcl::isFinite(point))
      finite->push_back(point);
  if (finite->empty())
    giveUp(file);
  return finite;
}

/** Names of the .pcd files in a folder, sorted. */
inline std::vector<std::string>
scansIn(const std::string& folder)
{
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".pcd")
      files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  return files;
}

/** A 4 x 4 matrix in a text file; identity without a file. */
inline Eigen::Matrix4f
readGuess(const std::string& file)
{
  Eigen::Matrix4f guess = Eigen::Matrix4f::Identity();
  if (file.empty())
    return guess;
  std::ifstream stream(file);
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      stream >> guess(row, column);
  if (!stream)
    giveUp(file);
  return guess;
}

/** Columns x, y, z [m]. */
inline Eigen::Matrix3Xf
pointsOf(const Cloud& cloud)
{
  Eigen::Matrix3Xf points(3, static_cast<Eigen::Index>(cloud.size()));
  for (std::size_t i = 0; i < cloud.size(); ++i)
    points.col(static_cast<Eigen::Index>(i)) = cloud[i].getVector3fMap();
  return points;
}

inline Cloud::Ptr
cloudOf(const Eigen::Matrix3Xf& points)
{
  const Cloud::Ptr cloud(new Cloud);
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    cloud->emplace_back(points(0, i), points(1, i), points(2, i));
  return cloud;
}

/** \p size points: evenly thinned, or repeated with 1 mm of noise. */
inline Eigen::Matrix3Xf
resized(const Eigen::Matrix3Xf& points, Eigen::Index size)
{
  std::mt19937 generator(1);
  std::normal_distribution<float> noise(0.f, 0.001f);
  Eigen::Matrix3Xf result(3, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    if (size <= points.cols())
      result.col(i) = points.col(i * points.cols() / size);
    else
      result.col(i) = points.col(i % points.cols()) +
                      Eigen::Vector3f::NullaryExpr([&]() { return noise(generator); });
  }
  return result;
}
