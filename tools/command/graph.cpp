#include "tools/command/graph.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "core/graph/graph_solver.hpp"
#include "tools/output/g2o.hpp"
#include "tools/output/whole_file.hpp"
#include "tools/replay/summary.hpp"

namespace odoless {
namespace {

struct SolveJob {
  std::filesystem::path file;
  std::filesystem::path out;
  int iterations = 50;
  bool robust = false;
};

void run_solve(const SolveJob& job) {
  PoseGraph graph = read_g2o(job.file);
  for (Constraint& constraint : graph.constraints()) {
    constraint.is_loop = constraint.is_loop && job.robust;
  }
  const auto chi2 = [&graph] {
    double sum = 0.0;
    for (const Constraint& constraint : graph.constraints()) {
      sum += squared_error(graph, constraint);
    }
    return sum;
  };
  const double before = chi2();
  const ResourceMeter meter;
  GraphSolver solver;
  const GraphSolver::Report report = solver.solve(graph, job.iterations);
  fmt::print("{} vertices, {} edges: squared error {:.6g}, before {:.6g}; {} iterations in {:.2f} s of CPU\n",
             graph.size(), graph.constraints().size(), chi2(), before, report.iterations, meter.cpu_s());
  if (!job.out.empty()) {
    write_whole_file(job.out, format_g2o(graph));
  }
}

}  // namespace

void add_graph(CLI::App& app) {
  CLI::App* const graph = app.add_subcommand("graph", "Pose graphs");
  graph->require_subcommand(1);
  const auto job = std::make_shared<SolveJob>();
  CLI::App* const solve = graph->add_subcommand("solve", "Move the vertices of a graph to where its edges agree best");
  solve->add_option("FILE", job->file, "Pose graph in the plane as g2o writes it; .gz and .xz are read too")
      ->required();
  solve->add_option("--out", job->out, "File for the solved graph");
  solve->add_option("--iterations", job->iterations, "Most iterations")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  solve->add_flag("--robust", job->robust,
                  "Count edges that disagree with the others less (dynamic covariance scaling), but for those between "
                  "vertices that follow each other");
  solve->callback([job] { run_solve(*job); });
}

}  // namespace odoless
