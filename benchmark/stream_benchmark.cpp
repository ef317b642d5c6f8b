// Registers a sequence of scans, each to the scan before it or all to the first one, as
// a program on a robot would: one object, preset `calibrated`, the mean in place of
// ICP. Prints scans per second, latency and memory.
#include "benchmark_clouds.h"

#include <pcl/console/print.h>
#include <pcl/registration/bayesian_icp.h>

#include <boost/program_options.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

namespace po = boost::program_options;

using Point = pcl::PointXYZ;

struct Request {
  std::string folder;
  std::size_t num_scans = 1000;
  unsigned int num_threads = 0;
  bool is_target_kept = false;
};

/** Of this process [MB]. */
double
residentMemory()
{
  std::ifstream status("/proc/self/statm");
  double total = 0.0, resident = 0.0;
  status >> total >> resident;
  constexpr double page_size = 4096.0;
  return resident * page_size / 1e6;
}

std::vector<Cloud::Ptr>
readScans(const std::string& folder)
{
  std::vector<Cloud::Ptr> scans;
  for (const auto& file : scansIn(folder))
    scans.push_back(readCloud(file));
  if (scans.size() < 2)
    throw std::runtime_error(folder + " has fewer than two .pcd files");
  return scans;
}

/** There and back again through the sequence, so that each scan is next to its
 * neighbours: 0, 1, ..., n - 1, n - 2, ..., 1, 0, 1, ... */
std::size_t
scanAt(std::size_t step, std::size_t num_scans)
{
  const std::size_t place = step % (2 * (num_scans - 1));
  return std::min(place, 2 * (num_scans - 1) - place);
}

/** The value that a part of all is below; \p values are sorted. */
double
quantile(const std::vector<double>& values, double part)
{
  return values[static_cast<std::size_t>(part * double(values.size() - 1))];
}

void
run(const Request& request)
{
  pcl::console::setVerbosityLevel(pcl::console::L_ERROR); // no warning of each scan
  const std::vector<Cloud::Ptr> scans = readScans(request.folder);
  pcl::BayesianIterativeClosestPoint<Point, Point> icp;
  icp.setUseMeanAsFinalTransformation(true);
  icp.setNumberOfThreads(request.num_threads);
  Cloud::ConstPtr target = scans[0];
  icp.setInputTarget(target);
  std::vector<double> latencies; // [ms]
  std::size_t num_usable = 0;
  double memory_at_tenth = 0.0;
  Cloud output;
  for (std::size_t step = 1; step <= request.num_scans; ++step) {
    const std::size_t scan = request.is_target_kept ? 1 + step % (scans.size() - 1)
                                                    : scanAt(step, scans.size());
    // No two scans of a sensor are the same, and the object remembers the last two.
    const auto source = scans[scan]->makeShared();
    source->front().x += 1e-6f * static_cast<float>(step);
    const auto start = std::chrono::steady_clock::now();
    if (!request.is_target_kept)
      icp.setInputTarget(target);
    icp.setInputSource(source);
    icp.align(output);
    const std::chrono::duration<double, std::milli> elapsed =
        std::chrono::steady_clock::now() - start;
    latencies.push_back(elapsed.count());
    num_usable += bayesian_icp::hasUsableMean(icp.getSummary().status);
    target = source;
    if (step == std::max<std::size_t>(1, request.num_scans / 10))
      memory_at_tenth = residentMemory();
    if (step % 50 == 0)
      std::fprintf(stderr, "\r%zu of %zu scans", step, request.num_scans);
  }
  std::fprintf(stderr, "\r");
  double sum = 0.0;
  for (const double latency : latencies)
    sum += latency;
  std::sort(latencies.begin(), latencies.end());
  std::printf("scans registered       %zu, %zu with a usable mean\n"
              "scans per second       %.1f\n"
              "latency p50, p95, max  %.0f, %.0f, %.0f ms\n"
              "memory                 %.0f MB after a tenth, %.0f MB at the end\n",
              latencies.size(),
              num_usable,
              1000.0 * double(latencies.size()) / sum,
              quantile(latencies, 0.5),
              quantile(latencies, 0.95),
              latencies.back(),
              memory_at_tenth,
              residentMemory());
}

} // namespace

int
main(int argc, char** argv)
{
  Request request;
  po::options_description options("Options");
  options.add_options()("help", "this text")(
      "scans", po::value(&request.num_scans), "number of registrations; default 1000")(
      "threads",
      po::value(&request.num_threads),
      "OpenMP threads; default 0, automatic")(
      "keep-target",
      po::bool_switch(&request.is_target_kept),
      "register all scans to the first one, in place of each to the one before it")(
      "folder", po::value(&request.folder)->required(), "folder with scans, .pcd");
  po::positional_options_description places;
  places.add("folder", 1);
  try {
    po::variables_map values;
    po::store(
        po::command_line_parser(argc, argv).options(options).positional(places).run(),
        values);
    if (values.count("help") > 0) {
      std::cout << "Usage: stream_benchmark FOLDER [options]\n" << options;
      return 0;
    }
    po::notify(values);
    if (request.num_scans == 0)
      throw po::error("--scans must be positive");
    run(request);
  }
  catch (const po::error& error) {
    std::cerr << "stream_benchmark: " << error.what() << '\n';
    return 2;
  }
  catch (const std::exception& error) {
    std::cerr << "stream_benchmark: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
