#include "converters.h"

#include <bayesian_icp/exports.h>
#include <bayesian_icp/options.h>

#include <string>
#include <type_traits>

namespace py = pybind11;

namespace bayesian_icp::python {

namespace {

/** \return \p value, or an error with the name and the meaning of the option */
template <typename Value>
Value
valueOf(const py::object& value, const char* name, const char* doc)
{
  if constexpr (std::is_same_v<Value, Vector6d> ||
                std::is_same_v<Value, Automatic<Vector6d>>)
    if (!value.is_none())
      return py::module_::import("bayesian_icp._checks")
          .attr("numbers")(name, value, py::make_tuple(6))
          .cast<Vector6d>();
  try {
    return value.cast<Value>();
  }
  catch (const py::value_error& error) {
    throw py::value_error(std::string(name) + ": " + error.what());
  }
  catch (const py::builtin_exception&) { // cast_error, or for None reference_cast_error
    const std::string text = py::str("{} is {!r}, but must fit its description: {}")
                                 .format(name, value, doc);
    if (PyIndex_Check(value.ptr()) != 0) // out of range, or an array of another shape
      throw py::value_error(text);
    throw py::type_error(text);
  }
}

/** A structure of options, whose fields are bound one after the other. */
template <typename Struct>
class Fields : public py::class_<Struct> {
public:
  Fields(py::module_& module, const char* name, const char* doc)
  : py::class_<Struct>(module, name, doc)
  {
    this->attr("_names") = py::list();
    this->def(py::init(&copyOf),
              py::arg("other") = py::none(),
              "A copy of other, or the defaults, with the fields that are given.");
    this->def("__repr__", [](const py::object& self) {
      py::list texts;
      for (const auto& [field, value] : fieldsOf(self))
        texts.append(py::str("{}={!r}").format(field, value));
      return py::str("{}({})").format(py::type::of(self).attr("__name__"),
                                      py::str(", ").attr("join")(texts));
    });
    this->def(py::pickle(&fieldsOf, [](const py::dict& fields) {
      return copyOf(nullptr, py::kwargs(fields));
    }));
  }

  /** Other than def_readwrite(), a bad value is refused with the field's name. */
  template <typename Value>
  Fields&
  add(const char* name, Value Struct::*field, const char* doc)
  {
    return add(
        name,
        [field](Struct& self) -> Value& { return self.*field; },
        [=](Struct& self, const py::object& value) {
          self.*field = valueOf<Value>(value, name, doc);
        },
        doc);
  }

  template <typename Getter, typename Setter>
  Fields&
  add(const char* name, const Getter& getter, const Setter& setter, const char* doc)
  {
    this->attr("_names").attr("append")(name);
    this->def_property(
        name,
        py::cpp_function(getter, py::return_value_policy::reference_internal),
        setter,
        doc);
    return *this;
  }

private:
  static Struct
  copyOf(const Struct* other, const py::kwargs& fields)
  {
    const py::object self = py::cast(other != nullptr ? *other : Struct());
    for (const auto& [name, value] : fields)
      py::setattr(self, name, value);
    return self.cast<Struct>();
  }

  static py::dict
  fieldsOf(const py::object& self)
  {
    py::dict fields;
    for (const py::handle name : self.attr("_names"))
      fields[name] = self.attr(name);
    return fields;
  }
};

/** The prior's mean; \c automatic is the guess. */
Automatic<Vector6d>
meanOf(const PriorOptions& prior)
{
  return prior.mean.array().isNaN().all() ? Automatic<Vector6d>() : prior.mean;
}

void
setMean(PriorOptions& prior, const py::object& value)
{
  const char* const doc = "six finite numbers, or None: the initial guess";
  const auto mean = valueOf<Automatic<Vector6d>>(value, "mean", doc);
  if (!mean.valueOr(Vector6d::Zero()).allFinite())
    throw py::value_error(py::str("mean is {}, but must be {}").format(value, doc));
  prior.mean = mean.valueOr(PriorOptions().mean);
}

void
bindShared(py::module_& module)
{
  Fields<PriorOptions>(module,
                       "PriorOptions",
                       "What is known about the pose before the clouds are seen.")
      .add("mean",
           &meanOf,
           &setMean,
           "(6,) T_target_source as finite x, y, z, roll, pitch, yaw [m, rad]; None: "
           "the initial guess.")
      .add("variance",
           &PriorOptions::variance,
           "(6,) variances [m^2, rad^2], positive; infinity means no prior on a "
           "coordinate, which preset calibrated refuses.")
      .add("frame",
           &PriorOptions::frame,
           "The point whose translation x, y, z describe: origin, source-centroid or "
           "automatic.");
  Fields<ChainOptions>(module, "ChainOptions", "How many chains and draws.")
      .add("num_chains", &ChainOptions::num_chains, "Independent chains, positive.")
      .add("num_draws",
           &ChainOptions::num_draws,
           "Draws kept over all chains, at least one per chain.")
      .add("seed",
           &ChainOptions::seed,
           "Seed of all random numbers, an integer from 0 to 2^64-1.")
      .add("num_threads",
           &ChainOptions::num_threads,
           "Threads, 1024 at most; 0: as many as OpenMP takes. No draw depends on it.");
  Fields<LikelihoodScale>(
      module, "LikelihoodScale", "The energy is N / sigma^2 times a mean over points.")
      .add("effective_points",
           &LikelihoodScale::effective_points,
           "N of the paper's eq. (5), positive; not the size of the cloud.")
      .add("measurement_sigma",
           &LikelihoodScale::measurement_sigma,
           "Standard deviation of a point-to-point distance [m], positive.");
}

void
bindPaper(py::module_& module)
{
  Fields<SgldOptions>(module, "SgldOptions", "Constants of Algorithm 1.")
      .add("step_size", &SgldOptions::step_size, "alpha, positive.")
      .add("decay_rate", &SgldOptions::decay_rate, "beta, in [0, 1).")
      .add("lambda_rms", &SgldOptions::lambda_rms, "lambda [m, m^2/rad], positive.")
      .add("noise_factor",
           &SgldOptions::noise_factor,
           "Factor on the variance of the injected noise; 1 is right.")
      .add("block_decay_factor",
           &SgldOptions::block_decay_factor,
           "Multiplies alpha at the end of a chain, in (0, 1]; 1 is off.")
      .add("block_decay_interval",
           &SgldOptions::block_decay_interval,
           "Steps between two reductions, positive.")
      .add("block_decay_start",
           &SgldOptions::block_decay_start,
           "Where reductions begin, as a fraction of the chain, in [0, 1].");
  Fields<PaperOptions>(module, "PaperOptions", "Options of preset paper.")
      .add("scale", &PaperOptions::scale, "Scale of the likelihood.")
      .add("batch_size", &PaperOptions::batch_size, "Source points in each step.")
      .add("sampling",
           &PaperOptions::sampling,
           "How they are chosen: with-replacement or shuffled-epochs.")
      .add("sgld", &PaperOptions::sgld, "Constants of Algorithm 1.")
      .add("max_distance",
           &PaperOptions::max_distance,
           "Gate on the distance of corresponding points [m]; infinity is none.")
      .add("num_burn_in", &PaperOptions::num_burn_in, "First steps, not kept.")
      .add("thinning", &PaperOptions::thinning, "Steps per kept draw, positive.")
      .add("initial_spread",
           &PaperOptions::initial_spread,
           "(6,) standard deviation of the starts about the guess [m, rad].");
}

void
bindExact(py::module_& module)
{
  Fields<ResidualOptions>(module, "ResidualOptions", "Energy of a source point.")
      .add("residual",
           &ResidualOptions::residual,
           "point-to-point, point-to-plane or distribution-to-distribution.")
      .add("regularization",
           &ResidualOptions::regularization,
           "Of covariances of the last one: plane, frobenius or none.")
      .add("kernel", &ResidualOptions::kernel, "none, huber or tukey.")
      .add("kernel_width", &ResidualOptions::kernel_width, "[m], positive.")
      .add("max_distance",
           &ResidualOptions::max_distance,
           "Gate on the distance to the nearest target point [m]; infinity is none.");
  Fields<ExactOptions>(module, "ExactOptions", "Options of preset exact.")
      .add("scale", &ExactOptions::scale, "Scale of the likelihood.")
      .add("residual", &ExactOptions::residual, "Residual, kernel and gate.")
      .add("steps",
           &ExactOptions::steps,
           "automatic, langevin, metropolis, stein-gradient or stein-newton.")
      .add("num_particles",
           &ExactOptions::num_particles,
           "Number of particles of Stein steps, which replace the draws.")
      .add("batch_size",
           &ExactOptions::batch_size,
           "Source points in each Langevin step; None: found.")
      .add("max_step_size",
           &ExactOptions::max_step_size,
           "Largest size of a Langevin step, in (0, 1].")
      .add("num_burn_in",
           &ExactOptions::num_burn_in,
           "Steps after the warm-up that are not kept; None: found.")
      .add("thinning", &ExactOptions::thinning, "Steps per kept draw; None: found.")
      .add("initial_spread",
           &ExactOptions::initial_spread,
           "(6,) standard deviation of the starts about the guess [m, rad]; None: the "
           "prior's, at most 0.5.")
      .add("max_source_points",
           &ExactOptions::max_source_points,
           "Largest number of source points that are used.");
}

} // namespace

void
bindOptions(py::module_& module)
{
  bindShared(module);
  bindPaper(module);
  bindExact(module);
  Fields<CalibratedOptions>(
      module, "CalibratedOptions", "Options of preset calibrated.")
      .add("max_source_points",
           &CalibratedOptions::max_source_points,
           "Largest number of points of each cloud that are used, at least 30. Up to a "
           "fifth as many come on top where only they hold a motion.")
      .add("num_mode_points",
           &CalibratedOptions::num_mode_points,
           "Of these, the number used to follow the starts to their modes.")
      .add("num_burn_in",
           &CalibratedOptions::num_burn_in,
           "First steps of each chain, not kept; None: found.")
      .add("thinning",
           &CalibratedOptions::thinning,
           "Steps per kept draw; None: found.");
  Fields<Options>(module,
                  "Options",
                  "All options of the posterior: what all presets share, and those of "
                  "each preset.\n\nOnly those of the chosen preset are used.")
      .add("preset", &Options::preset, "paper, exact or calibrated.")
      .add("prior", &Options::prior, "The prior.")
      .add("chains", &Options::chains, "Chains, draws, seed, threads.")
      .add("paper", &Options::paper, "Options of preset paper.")
      .add("exact", &Options::exact, "Options of preset exact.")
      .add("calibrated", &Options::calibrated, "Options of preset calibrated.")
      .def("validate",
           &Options::validate,
           "The first bad field with its value and range, in words; empty if all are "
           "good.");
  Fields<ExportOptions>(module, "ExportOptions", "What exports need besides the pose.")
      .add("target_frame", &ExportOptions::target_frame, "Name of the target's frame.")
      .add("timestamp_ns",
           &ExportOptions::timestamp_ns,
           "Time since the epoch, an integer [ns].")
      .add("target_vertex", &ExportOptions::target_vertex, "Vertex of a pose graph.")
      .add("source_vertex", &ExportOptions::source_vertex, "Vertex of a pose graph.")
      .add("accept_unreliable",
           &ExportOptions::accept_unreliable,
           "Also export a posterior whose status is worse than doubtful.");
}

} // namespace bayesian_icp::python
