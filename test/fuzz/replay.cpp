/** \file
 * \brief Gives a fuzzer the files of a folder, in the order of their names, where it is
 * built without libFuzzer.
 */
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <set>
#include <string>

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

// A fuzzer may have none.
extern "C" __attribute__((weak)) int
LLVMFuzzerInitialize(int* argc, char*** argv);

// What a fuzzer that has it says after all inputs: options change, and the bytes of
// inputs then may mean other ones, that are refused.
extern "C" __attribute__((weak)) bool
isCorpusReachingResults();

int
main(int argc, char** argv)
{
  if (argc != 2 || !std::filesystem::is_directory(argv[1])) {
    std::cerr << "Usage: " << argv[0] << " FOLDER\n";
    return EXIT_FAILURE;
  }
  std::set<std::filesystem::path> inputs;
  for (const auto& entry : std::filesystem::directory_iterator(argv[1]))
    inputs.insert(entry.path());
  if (inputs.empty()) {
    std::cerr << "no input in " << argv[1] << '\n';
    return EXIT_FAILURE;
  }
  if (LLVMFuzzerInitialize != nullptr)
    LLVMFuzzerInitialize(&argc, &argv);
  for (const std::filesystem::path& input : inputs) {
    // The last name is that of a crash.
    std::cout << input.filename().string() << std::endl;
    std::ifstream stream(input, std::ios::binary);
    const std::string bytes(std::istreambuf_iterator<char>(stream), {});
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()),
                           bytes.size());
  }
  if (isCorpusReachingResults != nullptr && !isCorpusReachingResults()) {
    std::cerr << "too few inputs in " << argv[1] << " lead to a result\n";
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
