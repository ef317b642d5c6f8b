#include "io/interrupt.h"
#include "register/run.h"
#include "viewer/drawing.h"
#include "viewer/live_state.h"

#include <bayesian_icp/random.h>

#include <pcl/visualization/pcl_visualizer.h>

#include <chrono>
#include <future>

namespace bayesian_icp::viewer {

namespace {

constexpr std::chrono::milliseconds frame(40);
/** Of each chain's cloud: all chains together stay as light as one scan. */
constexpr Eigen::Index max_points_of_chain = 4000;

/** Of the chains, one after the other, beginning again after the last one. */
constexpr std::array<Color, 6> chain_colors = {{{0.90, 0.62, 0.00},
                                                {0.00, 0.62, 0.45},
                                                {0.86, 0.35, 0.67},
                                                {0.94, 0.89, 0.26},
                                                {0.84, 0.37, 0.00},
                                                {0.34, 0.71, 0.91}}};

Eigen::Matrix3Xd
someOf(const Eigen::Matrix3Xd& points)
{
  Random random(1, 0);
  return points(Eigen::all, randomChoice(points.cols(), max_points_of_chain, random));
}

std::string
textOf(const LiveSnapshot& state)
{
  if (state.total_steps > 0)
    return "sampling: " + std::to_string(state.steps) + " of " +
           std::to_string(state.total_steps) + " steps";
  return "ICP: " + std::to_string(state.icp_iterations) + " iterations";
}

/** The picture of a snapshot. */
class LiveDrawing {
public:
  LiveDrawing(const Scene& scene, const ViewOptions& options, Window& window)
  : options_(options)
  , window_(window)
  , chain_points_(someOf(scene.source))
  {
    window.makePanels(1);
    addPoints(scene.target, options.styleOf(Layer::Target), "target", 0, window);
    addPoints(scene.source, options.styleOf(Layer::Source), "icp", 0, window);
    window.lookAt(shownPoints(scene, {Layer::Source, Layer::Target}),
                  defaultView(scene.target, scene.sensor_origin),
                  window.areaBeside(3, 0, false));
  }

  void
  draw(const LiveSnapshot& state)
  {
    moveCloud("icp", state.icp_matrix);
    window_.visualizer().getCloudActorMap()->at("icp").actor->SetVisibility(
        state.total_steps == 0);
    for (std::size_t i = 0; i < state.chains.size(); ++i)
      if (!state.chains[i].trace.empty())
        drawChain(state.chains[i], i);
    drawLegend(state);
  }

private:
  void
  moveCloud(const std::string& id, const Eigen::Matrix4d& matrix)
  {
    window_.visualizer().updatePointCloudPose(id,
                                              Eigen::Affine3f(matrix.cast<float>()));
  }

  void
  drawChain(const ChainTrack& track, std::size_t index)
  {
    const Color& color = chain_colors[index % chain_colors.size()];
    const std::string cloud = "chain/" + std::to_string(index);
    const std::string trace = "trace/" + std::to_string(index);
    auto& visualizer = window_.visualizer();
    if (!visualizer.contains(cloud))
      addPoints(chain_points_, {color, 3, 0.5}, cloud, 0, window_);
    moveCloud(cloud, matrixOf(track.pose));
    visualizer.removePointCloud(trace);
    addPoints(Eigen::Map<const Eigen::Matrix3Xd>(
                  track.trace.front().data(), 3, Eigen::Index(track.trace.size())),
              {color, 3, 1.0},
              trace,
              0,
              window_);
  }

  void
  drawLegend(const LiveSnapshot& state)
  {
    std::vector<LegendLine> lines = {{"target", options_.styleOf(Layer::Target).color}};
    if (state.total_steps == 0)
      lines.push_back({"source, moved by ICP", options_.styleOf(Layer::Source).color});
    for (std::size_t i = 0; i < state.chains.size(); ++i)
      lines.push_back({"chain " + std::to_string(i) +
                           (i == 0 ? ": source now; dots: way of its centroid" : ""),
                       chain_colors[i % chain_colors.size()]});
    lines.push_back({textOf(state), textColorOn(options_.background)});
    for (std::size_t i = 0; i < num_legend_lines_; ++i)
      window_.visualizer().removeShape("legend/0/" + std::to_string(i));
    window_.addLegend(lines, 0);
    num_legend_lines_ = lines.size();
  }

  const ViewOptions& options_;
  Window& window_;
  Eigen::Matrix3Xd chain_points_;
  std::size_t num_legend_lines_ = 0;
};

} // namespace

void
registerLive(const Scene& scene,
             const ViewOptions& options,
             Window& window,
             app::Run& run)
{
  LiveState state(scene.source.rowwise().mean());
  LiveDrawing drawing(scene, options, window);
  auto registration = std::async(std::launch::async, [&state, &run] {
    run.result = app::registerClouds(
        run.source.points,
        run.target.points,
        run.settings,
        [&state](const Progress& progress) {
          return state.moveChain(progress) && !io::wasInterrupted();
        },
        [&state](const Eigen::Matrix4d& matrix) { state.moveIcp(matrix); });
  });
  while (registration.wait_for(frame) != std::future_status::ready) {
    if (options.isOffScreen())
      continue;
    drawing.draw(state.snapshot());
    window.spinOnce(1);
    if (window.isClosed())
      state.stop();
  }
  registration.get();
  drawing.draw(state.snapshot());
}

} // namespace bayesian_icp::viewer
