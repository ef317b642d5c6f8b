// The report, and what its parts share: scans, and numbers printed to the last bit.
#pragma once

#include <bayesian_icp/pipeline.h>
#include <bayesian_icp/random.h>

#include <pcl/point_cloud.h>

#include <iostream>

// Two scans of a bumpy surface with 2 mm of noise, in sums and products only.
template <typename Point>
typename pcl::PointCloud<Point>::Ptr
scan(std::uint64_t seed, int num_points)
{
  bayesian_icp::Random random(seed, 0);
  typename pcl::PointCloud<Point>::Ptr cloud(new pcl::PointCloud<Point>);
  for (int i = 0; i < num_points; ++i) {
    const double x = random.uniform() - 0.5;
    const double y = random.uniform() - 0.5;
    double z = 2.0 * x * (x - 0.3) * (x + 0.4) + 3.0 * y * y * (y + 0.2);
    for (int k = 0; k < 12; ++k)
      z += 0.002 * (random.uniform() - 0.5);
    Point point{};
    point.x = static_cast<float>(x);
    point.y = static_cast<float>(y);
    point.z = static_cast<float>(z);
    cloud->push_back(point);
  }
  return cloud;
}

template <typename Derived>
void
print(const char* name, const Eigen::MatrixBase<Derived>& matrix)
{
  std::cout << name << std::hexfloat;
  for (Eigen::Index row = 0; row < matrix.rows(); ++row)
    for (Eigen::Index col = 0; col < matrix.cols(); ++col)
      std::cout << ' ' << matrix(row, col);
  std::cout << std::defaultfloat << '\n';
}

template <typename Registration>
void
printPosterior(const char* name, const Registration& registration)
{
  const auto& summary = registration.getSummary();
  std::cout << name << ": " << toString(summary.status) << ", " << summary.message
            << ", " << registration.getSamples().rows() << " draws\n";
  print(" mean", registration.getMean());
  print(" covariance",
        registration.getCovariance(bayesian_icp::CovarianceConvention::LeftSE3));
  print(" draws", registration.getSamples());
}

inline bayesian_icp::Options
reportOptions(bayesian_icp::Preset preset)
{
  bayesian_icp::Options options;
  options.preset = preset;
  options.exact.scale.measurement_sigma = 0.02;
  options.exact.scale.effective_points = 100.0;
  options.paper.scale = options.exact.scale;
  options.paper.sgld.step_size = 1e-8;
  options.chains.num_draws = 40;
  options.chains.num_threads = 2;
  return options;
}

// What the library answers for a point type that PCL has never heard of, by code
// compiled here.
void
reportOwnPointType();
