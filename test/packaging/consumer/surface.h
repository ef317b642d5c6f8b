// A pair of clouds with a known pose between them, and how to check what was estimated.
#pragma once

#include <pcl/common/transforms.h>
#include <pcl/point_cloud.h>

#include <Eigen/Geometry>

#include <cmath>
#include <iostream>

// Source and target frame differ by less than the points' spacing, so that the nearest
// neighbour is the right one and ICP finds the pose to rounding.
template <typename Point>
struct ScanPair {
  typename pcl::PointCloud<Point>::Ptr source{new pcl::PointCloud<Point>};
  typename pcl::PointCloud<Point>::Ptr target{new pcl::PointCloud<Point>};
  Eigen::Affine3f T_target_source =
      Eigen::Translation3f(0.01f, -0.02f, 0.015f) *
      Eigen::AngleAxisf(0.01f, Eigen::Vector3f(1.f, 2.f, 3.f).normalized());

  ScanPair()
  {
    for (int i = -10; i <= 10; ++i)
      for (int j = -10; j <= 10; ++j) {
        Point point{};
        point.x = 0.1f * static_cast<float>(i);
        point.y = 0.1f * static_cast<float>(j);
        point.z = 0.3f * std::sin(2.f * point.x) * std::cos(3.f * point.y);
        target->push_back(point);
      }
    pcl::transformPointCloud(*target, *source, T_target_source.inverse());
  }
};

inline bool
expect(bool condition, const char* what)
{
  if (!condition)
    std::cerr << "not so: " << what << '\n';
  return condition;
}
