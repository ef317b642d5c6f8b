#include "fuzz_input.h"

#include "io/errors.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>

namespace bayesian_icp::fuzz {

namespace {

/** A new folder that goes, with all that is in it, when this does. */
struct TemporaryFolder {
  std::string path =
      (std::filesystem::temp_directory_path() / "bayesian_icp.XXXXXX").string();

  TemporaryFolder()
  {
    require(mkdtemp(path.data()) != nullptr,
            "the folder for temporary files can be written");
  }

  ~TemporaryFolder() { std::filesystem::remove_all(path); }
};

} // namespace

std::string
writeInput(const std::string& name, std::string_view bytes)
{
  static const TemporaryFolder folder;
  std::string path = folder.path + '/' + name;
  // ext4 puts a file that was cut to nothing on the disk before it goes on.
  std::remove(path.c_str());
  std::ofstream stream(path, std::ios::binary | std::ios::trunc);
  stream << bytes;
  stream.close();
  require(!stream.fail(),
          "the input cannot be written to the folder for temporary files");
  return path;
}

bool
isAccepted(const std::function<void()>& read)
{
  try {
    read();
    return true;
  }
  catch (const io::FileError&) {
    return false;
  }
  catch (const io::UsageError&) {
    return false;
  }
}

void
require(bool holds, const char* what)
{
  if (holds)
    return;
  std::cerr << "violated: " << what << std::endl;
  std::abort();
}

} // namespace bayesian_icp::fuzz
