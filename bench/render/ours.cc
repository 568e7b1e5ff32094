// bench-render: a robot moving in front of a fixed camera, for `lab bench render` and for the comparison of
// geometry with MuJoCo (tests/oracle/test_render.py).
//
// usage: bench-render export URDF WIDTH HEIGHT FRAMES FOLDER   meshes as MuJoCo reads them, scene.json
//        bench-render measure URDF WIDTH HEIGHT FRAMES FOLDER  depth-K.raw (float, m) and id-K.raw (uint16: body
//                                                             + 1) of each frame, rows from the top
//        bench-render time URDF WIDTH HEIGHT FRAMES            milliseconds a frame and of PNG, as JSON
#include <fmt/format.h>
#include <png.h>
#include <rbd/algorithm/configuration.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "lab/experiment/experiment_yaml.h"
#include "procs/renderer/robot_scene.h"
#include "render/png.h"
#include "render/renderer.h"

namespace {

using nlohmann::json;
namespace fs = std::filesystem;

struct Job {
  std::string urdf;
  int width, height, frames;
};

// A robot, its poses and the camera that sees them all.
struct Show {
  lab::Robot robot;
  std::vector<Eigen::VectorXd> poses;
  lab::render::Scene scene;
  lab::render::Camera camera;
  rbd::Data data;

  Show(const Job& job, const std::string& quality)
      : robot(lab::load_robot(lab::parse_experiment("robot: {model: \"" + job.urdf + "\"}", "bench"))),
        data(robot.model) {
    std::vector<std::string> warnings;
    std::vector<std::string> links;
    scene.bodies = lab::renderer::make_bodies(robot, quality, links, warnings);
    for (const std::string& warning : warnings) fmt::print(stderr, "bench-render: {}\n", warning);
    const rbd::Model& model = robot.model;
    lab::render::Bounds box;
    for (int k = 0; k < job.frames; ++k) {
      // every joint swings about its middle (or 0 if it has no limits), each in a phase of its own
      Eigen::VectorXd v = Eigen::VectorXd::Zero(model.nv);
      for (Eigen::Index i = 0; i < v.size(); ++i)
        v[i] = 0.4 * std::sin(2 * M_PI * k / job.frames + 1.7 * double(i));
      Eigen::VectorXd q = rbd::integrate(model, rbd::neutral(model), v);
      if (model.nq == model.nv) q = q.cwiseMax(model.lowerPositionLimit).cwiseMin(model.upperPositionLimit);
      poses.push_back(q);
      pose(k);
      box.extend(lab::render::bounds(scene));
    }
    scene.ground.height = box.min().z();
    camera = lab::render::auto_frame(box, "iso", double(job.width) / job.height);
  }
  void pose(int k) {
    lab::renderer::pose_bodies(robot.model, data, poses[static_cast<size_t>(k)], scene.bodies);
  }
};

json numbers(const Eigen::MatrixXd& m) { return std::vector<double>(m.data(), m.data() + m.size()); }

// MuJoCo's own format: four counts, then positions, normals, texture coordinates, triangles.
void write_msh(const fs::path& path, const lab::render::Mesh& mesh, const lab::render::Surface& surface,
               const Eigen::Vector3d& scale) {
  std::vector<float> positions, normals;
  std::vector<int32_t> faces;
  std::map<uint32_t, int32_t> number;
  for (uint32_t c = surface.first; c < surface.first + surface.count; ++c) {
    const uint32_t i = mesh.indices[c];
    const auto [it, fresh] = number.try_emplace(i, static_cast<int32_t>(number.size()));
    if (fresh) {
      const Eigen::Vector3f p = scale.cast<float>().cwiseProduct(mesh.positions[i]);
      const Eigen::Vector3f n = scale.cast<float>().cwiseInverse().cwiseProduct(mesh.normals[i]).normalized();
      positions.insert(positions.end(), p.data(), p.data() + 3);
      normals.insert(normals.end(), n.data(), n.data() + 3);
    }
    faces.push_back(it->second);
  }
  if (scale.prod() < 0)
    for (size_t t = 0; t < faces.size(); t += 3) std::swap(faces[t + 1], faces[t + 2]);
  const auto vertices = static_cast<int32_t>(number.size());
  const int32_t counts[] = {vertices, vertices, 0, static_cast<int32_t>(faces.size() / 3)};
  std::ofstream out(path, std::ios::binary);
  const auto put = [&](const auto* data, size_t count) {
    out.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(count * sizeof *data));
  };
  put(counts, 4);
  put(positions.data(), positions.size());
  put(normals.data(), normals.size());

  put(faces.data(), faces.size());
  if (!out.flush()) throw std::runtime_error(path.string() + ": cannot write");
}

json export_scene(const Job& job, const fs::path& folder) {
  Show show(job, "fine");
  fs::create_directories(folder);
  json bodies = json::array();
  int count = 0;
  for (const auto& body : show.scene.bodies) {
    json geoms = json::array();
    for (const auto& part : body.parts)
      for (const auto& surface : part.mesh->surfaces) {
        const std::string file = fmt::format("{}.msh", count++);
        write_msh(folder / file, *part.mesh, surface, part.scale);
        const Eigen::Vector4d rgba = (surface.coloured ? surface.rgba : part.rgba).cast<double>();
        const Eigen::Quaterniond turn(part.pose.linear());
        geoms.push_back({{"file", file},
                         {"rgba", numbers(rgba)},
                         {"pos", numbers(part.pose.translation())},
                         {"quat", {turn.w(), turn.x(), turn.y(), turn.z()}}});
      }
    bodies.push_back({{"name", body.name}, {"geoms", geoms}});
  }
  json frames = json::array();
  for (int k = 0; k < job.frames; ++k) {
    show.pose(k);
    json poses = json::array();
    for (const auto& body : show.scene.bodies) {
      const Eigen::Quaterniond turn(body.pose.linear());
      poses.push_back(
          {{"pos", numbers(body.pose.translation())}, {"quat", {turn.w(), turn.x(), turn.y(), turn.z()}}});
    }
    frames.push_back(poses);
  }
  return {{"width", job.width},
          {"height", job.height},
          {"floor", show.scene.ground.height},
          {"bodies", bodies},
          {"frames", frames},
          {"camera",
           {{"eye", numbers(show.camera.eye)},
            {"target", numbers(show.camera.target)},
            {"fov", show.camera.fov}}}};
}

template <class T>
void write_raw(const fs::path& path, const std::vector<T>& values) {
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(values.data()),
            static_cast<std::streamsize>(values.size() * sizeof(T)));
  if (!out.flush()) throw std::runtime_error(path.string() + ": cannot write");
}

void measure(const Job& job, const fs::path& folder) {
  Show show(job, "fine");
  for (size_t i = 0; i < show.scene.bodies.size(); ++i)
    for (auto& part : show.scene.bodies[i].parts) part.id = static_cast<uint16_t>(i + 1);
  lab::render::Renderer renderer(job.width, job.height);
  for (int k = 0; k < job.frames; ++k) {
    show.pose(k);
    const lab::render::Measurement seen = renderer.measure(show.scene, show.camera);
    write_raw(folder / fmt::format("depth-{}.raw", k), seen.depth);
    write_raw(folder / fmt::format("id-{}.raw", k), seen.id);
  }
}

struct Clock {
  double wall = 0, cpu = 0;  // ms
  static Clock now() {
    rusage use{};
    getrusage(RUSAGE_SELF, &use);
    const auto ms = [](const timeval& t) { return 1e3 * double(t.tv_sec) + 1e-3 * double(t.tv_usec); };
    return {std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch())
                .count(),
            ms(use.ru_utime) + ms(use.ru_stime)};
  }
};

// Level 1 with filter Sub, straight into memory: what is known to be best, without files and texts around it.
double bare_png(const lab::render::Image& image, size_t& size) {
  const double start = Clock::now().wall;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  std::string bytes;
  png_set_write_fn(
      png, &bytes,
      [](png_structp p, png_bytep data, size_t n) {
        static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<char*>(data), n);
      },
      nullptr);
  png_set_IHDR(png, info, static_cast<unsigned>(image.width), static_cast<unsigned>(image.height), 8,
               PNG_COLOR_TYPE_RGB, 0, 0, 0);
  png_set_compression_level(png, 1);
  png_set_filter(png, 0, PNG_FILTER_SUB);
  png_write_info(png, info);
  for (int y = 0; y < image.height; ++y) png_write_row(png, image.at(0, y));
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  size = bytes.size();
  return Clock::now().wall - start;
}

json time_all(const Job& job) {
  json out;
  lab::render::Image image;
  for (const char* quality : {"draft", "live", "fine"}) {
    const double begin = Clock::now().wall;
    Show show(job, quality);
    const double loaded = Clock::now().wall;
    lab::render::Renderer renderer(job.width, job.height, lab::render::quality_from_name(quality));
    size_t triangles = 0;
    for (const auto& body : show.scene.bodies)
      for (const auto& part : body.parts) triangles += part.mesh->triangles();
    show.pose(0);
    renderer.draw(show.scene, show.camera, image);  // shaders, uploads
    Clock best{1e9, 1e9};
    for (int round = 0; round < 3; ++round) {
      Clock sum;
      for (int k = 0; k < job.frames; ++k) {
        show.pose(k);
        const Clock start = Clock::now();
        renderer.draw(show.scene, show.camera, image);
        const Clock end = Clock::now();
        sum.wall += end.wall - start.wall;
        sum.cpu += end.cpu - start.cpu;
      }
      best.wall = std::min(best.wall, sum.wall / job.frames);

      best.cpu = std::min(best.cpu, sum.cpu / job.frames);
    }
    out["modes"][quality] = {
        {"ms", best.wall}, {"cpu_ms", best.cpu}, {"triangles", triangles}, {"load_ms", loaded - begin}};
    out["gl"] = renderer.gl_info();
  }
  double ours = 1e9, bare = 1e9;
  size_t size = 0;
  const fs::path file = fs::temp_directory_path() / fmt::format("bench-render-{}.png", getpid());
  for (int i = 0; i < 20; ++i) {
    const double start = Clock::now().wall;
    lab::render::write_png(file.string(), image, {{"run", "0"}});
    ours = std::min(ours, Clock::now().wall - start);
    bare = std::min(bare, bare_png(image, size));
  }
  fs::remove(file);
  out["png"] = {{"write_png_ms", ours}, {"bare_libpng_ms", bare}, {"bytes", size}};
  return out;
}

}  // namespace

int main(int argc, char** argv) try {
  const std::string verb = argc > 1 ? argv[1] : "";
  const bool to_folder = verb == "export" || verb == "measure";
  if (!(to_folder && argc == 7) && !(verb == "time" && argc == 6)) {
    fmt::print(stderr,
               "usage: bench-render export|measure URDF WIDTH HEIGHT FRAMES FOLDER | time URDF WIDTH HEIGHT "
               "FRAMES\n");
    return 2;
  }
  const Job job{fs::absolute(argv[2]).string(), std::stoi(argv[3]), std::stoi(argv[4]), std::stoi(argv[5])};
  if (verb == "time") fmt::print("{}\n", time_all(job).dump());
  if (verb == "export") {
    const json scene = export_scene(job, argv[6]);
    if (!(std::ofstream(fs::path(argv[6]) / "scene.json") << scene.dump() << std::flush))
      throw std::runtime_error("cannot write scene.json");
  }
  if (verb == "measure") measure(job, argv[6]);
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "bench-render: {}\n", error.what());
  return 1;
}
