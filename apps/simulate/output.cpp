#include "output.h"

#include "record.h"

#include <pcl/io/pcd_io.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace bayesian_icp {
namespace simulator {

namespace fs = std::filesystem;

namespace {

/** \brief Files under temporary names; those not renamed are removed at the end. */
class PendingFiles {
public:
  explicit PendingFiles(const fs::path& folder) : folder_(folder) {}
  PendingFiles(const PendingFiles&) = delete;
  PendingFiles&
  operator=(const PendingFiles&) = delete;

  ~PendingFiles()
  {
    std::error_code ignored;
    for (const File& file : files_)
      fs::remove(file.temporary, ignored);
  }

  /** \brief Announce a file; returns the name under which to write it. */
  fs::path
  add(const std::string& name)
  {
    const fs::path final_path = folder_ / name;
    if (fs::is_directory(final_path))
      throw std::runtime_error("cannot write " + final_path.string() +
                               ": there is a folder of this name");
    const std::string suffix = ".partial." + std::to_string(getpid());
    files_.push_back({folder_ / (name + suffix), final_path});
    return files_.back().temporary;
  }

  void
  renameAll() const
  {
    for (const File& file : files_)
      fs::rename(file.temporary, file.final_path);
  }

private:
  struct File {
    fs::path temporary;
    fs::path final_path;
  };

  fs::path folder_;
  std::vector<File> files_;
};

void
writeText(const fs::path& path, const std::string& text)
{
  std::ofstream file(path);
  file << text;
  file.close();
  if (!file)
    throw std::runtime_error("cannot write " + path.string());
}

void
writeCloud(const fs::path& path, const Eigen::Matrix3Xf& points)
{
  pcl::PointCloud<pcl::PointXYZ> cloud;
  cloud.reserve(static_cast<std::size_t>(points.cols()));
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    cloud.push_back(pcl::PointXYZ(points(0, i), points(1, i), points(2, i)));
  int status = 0;
  try {
    status = pcl::PCDWriter().writeBinaryCompressed(path.string(), cloud);
  }
  catch (const pcl::IOException& error) {
    throw std::runtime_error("cannot write " + path.string() + error.what());
  }
  if (status != 0)
    throw std::runtime_error("cannot write " + path.string());
}

std::string
textOfMatrix(const Eigen::Matrix4d& matrix)
{
  std::ostringstream text;
  text << std::setprecision(17);
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      text << matrix(row, column) << (column < 3 ? ' ' : '\n');
  return text.str();
}

} // namespace

void
writePair(const std::string& folder,
          const SimulationOptions& options,
          const ScanPair& pair)
{
  fs::create_directories(folder);
  PendingFiles files(folder);
  writeCloud(files.add("source.pcd"), pair.source);
  writeCloud(files.add("target.pcd"), pair.target);
  writeText(files.add("T_target_source.txt"), textOfMatrix(pair.T_target_source));
  writeText(files.add("scene.json"), recordOf(options, pair).dump(2) + '\n');
  files.renameAll();
}

} // namespace simulator
} // namespace bayesian_icp
