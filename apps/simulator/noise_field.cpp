#include "simulator/noise_field.h"

#include "threads/for_each_piece.h"

#include <bayesian_icp/random.h>

#include <cmath>

namespace bayesian_icp::simulator {

namespace {

/** \brief Gaussian of 2 radius + 1 entries whose squares add up to one, so that blurred
 * white noise keeps its variance. */
Eigen::ArrayXd
blurKernel(double standard_deviation)
{
  const int radius = static_cast<int>(std::ceil(3.0 * standard_deviation));
  Eigen::ArrayXd kernel(2 * radius + 1);
  for (int i = -radius; i <= radius; ++i) {
    const double deviations = i / standard_deviation;
    kernel[i + radius] = std::exp(-0.5 * deviations * deviations);
  }
  return kernel / std::sqrt(kernel.square().sum());
}

/** \brief White noise blurred along the row; \p kernel.size() - 1 more numbers than
 * columns are drawn. After the last column of a circle follows the first. */
Eigen::ArrayXd
blurredRow(int num_columns,
           const Eigen::ArrayXd& kernel,
           bool is_circular,
           Random random)
{
  Eigen::ArrayXd white(num_columns + kernel.size() - 1);
  for (double& value : white)
    value = random.normal();
  if (is_circular)
    for (Eigen::Index i = num_columns; i < white.size(); ++i)
      white[i] = white[i - num_columns];
  Eigen::ArrayXd blurred(num_columns);
  for (int column = 0; column < num_columns; ++column)
    blurred[column] = (kernel * white.segment(column, kernel.size())).sum();
  return blurred;
}

} // namespace

NoiseField::NoiseField(const SensorOptions& options,
                       std::uint64_t seed,
                       std::uint32_t scan_number)
: correlation_(options.noise_correlation)
{
  if (correlation_ <= 0.0)
    return;
  // The rays' own numbers come from the streams below this one.
  const std::uint64_t first_stream =
      (std::uint64_t{1} << 63) + (std::uint64_t{scan_number} << 32);
  const Eigen::ArrayXd kernel = blurKernel(options.noise_correlation_pixels);
  const int num_rows = numRows(options);
  const int num_columns = raysPerRow(options);
  Eigen::ArrayXXd rows(num_columns, num_rows + kernel.size() - 1);
  const bool is_circular = options.kind == SensorKind::Lidar;
  forEachPiece(rows.cols(), 0, [&](Eigen::Index row) {
    rows.col(row) =
        blurredRow(num_columns,
                   kernel,
                   is_circular,
                   Random(seed, first_stream + static_cast<std::uint64_t>(row)));
  });
  field_ = Eigen::ArrayXXd::Zero(num_columns, num_rows);
  forEachPiece(num_rows, 0, [&](int row) {
    for (Eigen::Index i = 0; i < kernel.size(); ++i)
      field_.col(row) += kernel[i] * rows.col(row + i);
  });
}

double
NoiseField::mixed(double independent, int row, int column) const
{
  if (correlation_ <= 0.0)
    return independent;
  return std::sqrt(1.0 - correlation_) * independent +
         std::sqrt(correlation_) * field_(column, row);
}

} // namespace bayesian_icp::simulator
