// How long does a building take to close and to mesh, and how uniform are its triangles? Beside gmsh
// (frontal, one thread) on the same faces where its program is installed. Usage: meshing_bench SKETCH.json...
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <vector>

#include <fmt/format.h>

#include "benches/bench_main.h"
#include "geometry/mesher.h"

using namespace heliodon::geometry;
namespace fs = std::filesystem;

namespace {

double cpuMs() {
    return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

// Median of 21 runs, in milliseconds of this process.
template<class Work> double medianMs(Work work) {
    std::vector<double> times;
    for (int run = 0; run < 21; ++run) {
        const double start = cpuMs();
        work();
        times.push_back(cpuMs() - start);
    }
    std::ranges::sort(times);
    return times[times.size() / 2];
}

void report(const std::string& sketch, const char* mesher, size_t asked, double ms, const MeshQuality& q) {
    std::printf("%s,%s,%zu,%zu,%.2f,%.1f,%.1f,%zu,%.3f\n", sketch.c_str(), mesher, asked, q.triangles, ms,
                q.minAngleDeg, q.minAngleAllDeg, q.stripTriangles, q.areaDeviation);
}

// The building's faces as plane surfaces that share their curves.
void writeGeo(const Building& building, double edge, const fs::path& file) {
    std::ofstream out(file);
    for (size_t v = 0; v < building.vertices.size(); ++v) {
        const glm::dvec3 p = building.vertices[v];
        out << fmt::format("Point({})={{{:.12g},{:.12g},{:.12g},{:.6g}}};\n", v + 1, p.x, p.y, p.z, edge);
    }
    std::map<std::pair<uint32_t, uint32_t>, int> lines;
    int next = 1;
    for (const Face& face : building.faces) {
        std::vector<int> loops;
        for (const auto& loop : face.loops) {
            std::string curve;
            for (size_t i = 0; i < loop.size(); ++i) {
                const uint32_t a = loop[i], b = loop[(i + 1) % loop.size()];
                const auto [line, isNew] = lines.try_emplace(std::minmax(a, b), next);
                if (isNew)
                    out << fmt::format("Line({})={{{},{}}};\n", next++, std::min(a, b) + 1,
                                       std::max(a, b) + 1);
                curve += fmt::format("{}{}", curve.empty() ? "" : ",", a < b ? line->second : -line->second);
            }
            out << fmt::format("Curve Loop({})={{{}}};\n", next, curve);
            loops.push_back(next++);
        }
        std::string all;
        for (const int loop : loops) all += fmt::format("{}{}", all.empty() ? "" : ",", loop);
        out << fmt::format("Plane Surface({})={{{}}};\n", next++, all);
    }
    out << "Mesh.Algorithm=6;\nMesh.MshFileVersion=2.2;\nMesh.SaveAll=1;\nGeneral.NumThreads=1;\n";
}

// Triangles of a .msh file, format 2.2, and the seconds that gmsh says it took.
PatchMesh readMsh(const fs::path& file) {
    PatchMesh mesh;
    std::ifstream in(file);
    std::map<int, uint32_t> nodes;
    for (std::string line; std::getline(in, line);) {
        size_t count = 0;
        if (line == "$Nodes") {
            in >> count;
            for (size_t i = 0; i < count; ++i) {
                int id = 0;
                glm::dvec3 p;
                in >> id >> p.x >> p.y >> p.z;
                nodes[id] = static_cast<uint32_t>(mesh.vertices.size());
                mesh.vertices.push_back(p);
            }
        } else if (line == "$Elements") {
            in >> count >> std::ws;
            for (size_t i = 0; i < count && std::getline(in, line); ++i) {
                std::istringstream fields(line);
                int id = 0, type = 0, tags = 0, physical = 0, surface = 0, tag = 0;
                fields >> id >> type >> tags >> physical >> surface;
                for (int k = 2; k < tags; ++k) fields >> tag;
                std::array<int, 3> corner{};
                if (type != 2 || !(fields >> corner[0] >> corner[1] >> corner[2])) continue;
                const std::array<uint32_t, 3> patch{nodes[corner[0]], nodes[corner[1]], nodes[corner[2]]};
                mesh.addPatch(patch, 0, Role::projection, static_cast<uint32_t>(surface), 0);
            }
        }
    }
    return mesh;
}

// gmsh has edge lengths, not counts: tuned until the count is near. Its own figure of CPU seconds for
// meshing.
void benchGmsh(const std::string& sketch, const Building& building, size_t asked, double area) {
    const fs::path folder = fs::temp_directory_path() / "heliodon_meshing_bench";
    fs::create_directories(folder);
    double edge = std::sqrt(4 / std::sqrt(3.0) * area / static_cast<double>(asked));
    for (int round = 0; round < 4; ++round) {
        writeGeo(building, edge, folder / "b.geo");
        const std::string command =
            fmt::format("gmsh -2 -nt 1 -o {0}/b.msh {0}/b.geo > {0}/log 2>&1", folder.string());
        if (std::system(command.c_str()) != 0) return;
        const PatchMesh mesh = readMsh(folder / "b.msh");
        const double count = static_cast<double>(mesh.patchCount()),
                     ratio = count / static_cast<double>(asked);
        if (count == 0) return;
        if (round < 3 && std::abs(ratio - 1) > 0.03) {
            edge *= std::sqrt(ratio);
            continue;
        }
        double seconds = 0;
        std::ifstream log(folder / "log");
        for (std::string line; std::getline(log, line);)
            if (const size_t at = line.find("CPU ");
                at != std::string::npos && line.find("meshing") != std::string::npos)
                seconds +=
                    std::strtod(line.c_str() + at + 4, nullptr); // "Done meshing 2D (Wall 0.02s, CPU 0.02s)"
        return report(sketch, "gmsh", asked, 1e3 * seconds, measureMesh(mesh));
    }
}

void bench(int count, char** arguments) {
    const bool gmsh = std::system("gmsh --version > /dev/null 2>&1") == 0;
    std::printf(
        "sketch,mesher,asked,triangles,ms,min_angle_deg,min_angle_all_deg,strip_triangles,area_deviation\n");
    for (int i = 1; i < count; ++i) {
        const Sketch sketch = readSketch(arguments[i]);
        const Closure closure = closeSketch(sketch);
        if (!closure.building) {
            std::fprintf(stderr, "%s: left out, %s\n", arguments[i], closure.report.message.c_str());
            continue;
        }
        std::printf("%s,closure,,,%.2f,,,,\n", sketch.id.c_str(), medianMs([&] { closeSketch(sketch); }));
        for (const size_t asked : {500u, 1000u, 2000u, 5000u, 10000u, 20000u, 50000u}) {
            const double meshing = medianMs([&] { meshBuilding(*closure.building, {asked}); });
            const PatchMesh mesh = meshBuilding(*closure.building, {asked});
            report(sketch.id, "heliodon", asked, meshing, measureMesh(mesh));
            double area = 0;
            for (size_t k = 0; k < mesh.patchCount(); ++k) area += patchArea(mesh, k);
            if (gmsh) benchGmsh(sketch.id, *closure.building, asked, area);
        }
    }
}

} // namespace

int main(int argc, char** argv) {
    return heliodon::benchMain(argc, argv, 1, "meshing_bench SKETCH.json...", bench);
}
