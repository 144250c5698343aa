#include "tools/output/g2o.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <iterator>
#include <unordered_map>
#include <vector>

#include "core/math/principal_axes.hpp"
#include "tools/command/error.hpp"
#include "tools/log/fields.hpp"
#include "tools/log/line_reader.hpp"

namespace odoless {
namespace {

constexpr std::size_t kIdMax = 1'000'000'000;
constexpr int kTriangle = 6;

class G2oReader {
 public:
  void add(const Fields& fields) {
    const std::string_view tag = fields.text(0);
    if (tag == "VERTEX_SE2") {
      fields.require(5, "VERTEX_SE2 id x y yaw");
      add_vertex(fields);
    } else if (tag == "EDGE_SE2") {
      fields.require(12, "EDGE_SE2 from to dx dy dyaw and 6 numbers of the information matrix");
      add_edge(fields);
    } else if (tag != "FIX") {
      fields.fail("an unknown tag", "VERTEX_SE2, EDGE_SE2 or FIX: a pose graph in the plane");
    }
  }

  [[nodiscard]] PoseGraph finish(const LineReader& lines) const {
    if (vertices_.empty()) {
      throw DataError(lines.name(), 0, "it has no vertex", "a pose graph with VERTEX_SE2 and EDGE_SE2");
    }
    PoseGraph graph(static_cast<int>(vertices_.size()), static_cast<int>(edges_.size()));
    for (const Pose2& pose : vertices_) {
      static_cast<void>(graph.add_node(pose));
    }
    for (const Constraint& edge : edges_) {
      graph.add(edge);
    }
    return graph;
  }

 private:
  void add_vertex(const Fields& fields) {
    const auto index = static_cast<int>(vertices_.size());
    if (!index_of_.emplace(fields.count(1, kIdMax, "id"), index).second) {
      fields.fail("a vertex that was there before", "each id once");
    }
    vertices_.push_back({fields.number(2, "x"), fields.number(3, "y"), wrap_angle(fields.number(4, "yaw"))});
  }

  [[nodiscard]] int vertex(const Fields& fields, std::size_t field) const {
    const auto found = index_of_.find(fields.count(field, kIdMax, "id"));
    if (found == index_of_.end()) {
      fields.fail("an edge of a vertex that is not there", "vertices before their edges");
    }
    return found->second;
  }

  void add_edge(const Fields& fields) {
    Constraint edge{.from = vertex(fields, 1), .to = vertex(fields, 2)};
    edge.from_T_to = {fields.number(3, "dx"), fields.number(4, "dy"), wrap_angle(fields.number(5, "dyaw"))};
    Eigen::Matrix3d information;
    std::size_t field = 12 - kTriangle;
    for (int row = 0; row < 3; ++row) {
      for (int column = row; column < 3; ++column) {
        information(row, column) = information(column, row) = fields.number(field++, "information");
      }
    }
    if (edge.from == edge.to || !(math::principal_axes<3>(information).values(0) > 0.0)) {
      fields.fail("an edge from a vertex to itself, or an information matrix that is not positive definite",
                  "an edge between two vertices with a positive definite information matrix");
    }
    edge.covariance = information.inverse();
    edge.is_loop = edge.to != edge.from + 1 && edge.from != edge.to + 1;
    edges_.push_back(edge);
  }

  std::unordered_map<std::size_t, int> index_of_;
  std::vector<Pose2> vertices_;
  std::vector<Constraint> edges_;
};

}  // namespace

std::string format_g2o(const PoseGraph& graph) {
  std::string text;
  const auto out = std::back_inserter(text);
  for (int node = 0; node < graph.size(); ++node) {
    const Pose2& pose = graph.pose(node);
    fmt::format_to(out, "VERTEX_SE2 {} {:.6f} {:.6f} {:.9f}\n", node, pose.x_m, pose.y_m, pose.yaw_rad);
  }
  for (const Constraint& each : graph.constraints()) {
    if (each.weight <= 0.0) {
      continue;
    }
    const Eigen::Matrix3d i = each.covariance.inverse();
    fmt::format_to(out, "EDGE_SE2 {} {} {:.6f} {:.6f} {:.9f} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g}\n", each.from,
                   each.to, each.from_T_to.x_m, each.from_T_to.y_m, each.from_T_to.yaw_rad, i(0, 0), i(0, 1), i(0, 2),
                   i(1, 1), i(1, 2), i(2, 2));
  }
  return text;
}

PoseGraph read_g2o(const std::filesystem::path& path) {
  LineReader lines(open_bytes(path), path.string());
  return read_g2o(lines);
}

PoseGraph read_g2o(LineReader& lines) {
  G2oReader reader;
  Fields fields;
  std::string_view line;
  while (lines.next(line)) {
    fields.split(line, lines);
    if (fields.size() > 0 && !fields.text(0).starts_with('#')) {
      lines.keep(sizeof(Constraint));
      reader.add(fields);
    }
  }
  return reader.finish(lines);
}

}  // namespace odoless
