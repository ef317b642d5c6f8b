#include "fuzz_input.h"

#include "io/errors.h"
#include "temporary_folder.h"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>

namespace bayesian_icp::fuzz {

std::string
writeInput(const std::string& name, std::string_view bytes)
{
  static const TemporaryFolder folder;
  std::string path = folder.path() + '/' + name;
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
