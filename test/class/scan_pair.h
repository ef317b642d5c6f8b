/** \file
 * \brief The committed pairs of scans.
 */
#pragma once

#include "support/registration_support.h"

#include <pcl/io/pcd_io.h>

#include <fstream>
#include <string>

namespace pcl::test {

/** A pair of scans of data/, and the pose between them. */
struct ScanPair {
  explicit ScanPair(const std::string& name)
  {
    const std::string folder = std::string(BAYESIAN_ICP_DATA_DIR) + "/" + name + "/";
    EXPECT_EQ(io::loadPCDFile(folder + "source.pcd", *source), 0);
    EXPECT_EQ(io::loadPCDFile(folder + "target.pcd", *target), 0);
    std::ifstream file(folder + "T_target_source.txt");
    for (int i = 0; i < 16; ++i)
      file >> T_target_source(i / 4, i % 4);
    EXPECT_FALSE(file.fail());
  }

  Cloud::Ptr source{new Cloud};
  Cloud::Ptr target{new Cloud};
  Eigen::Matrix4d T_target_source;
};

} // namespace pcl::test
