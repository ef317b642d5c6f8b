/** \file
 * \brief A folder for files on their way from one program to another.
 */
#pragma once

#include "io/errors.h"

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

namespace bayesian_icp::fuzz {

/** \brief A new folder that goes, with all that is in it, when this does. */
class TemporaryFolder {
public:
  /** \throws io::FileError if it cannot be made */
  TemporaryFolder()
  {
    std::error_code error;
    const auto parent = std::filesystem::temp_directory_path(error);
    path_ = (error ? std::filesystem::path("/tmp") : parent) / "bayesian_icp.XXXXXX";
    if (mkdtemp(path_.data()) == nullptr)
      throw io::FileError(path_,
                          "cannot be made: " + std::generic_category().message(errno));
  }

  ~TemporaryFolder()
  {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder&
  operator=(const TemporaryFolder&) = delete;

  const std::string&
  path() const
  {
    return path_;
  }

private:
  std::string path_;
};

} // namespace bayesian_icp::fuzz
