// The cases after CIE 171:2006 as their user has them: a model, a sky, a table of sensors, one command.
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "compute/daylight/sky.h"
#include "tests/app/program.h"
#include "tests/compute/cie171_rooms.h"
#include "tests/compute/rooms.h"

namespace heliodon::test {
namespace {

using cie171::Sensor;

class Cie171Command : public InFolder {
protected:
    // As a program for drawing rooms writes it: y up, one face a rectangle.
    void writeModel(const geometry::PatchMesh& mesh) const {
        std::string model = "mtllib room.mtl\n", materials;
        for (const glm::dvec3& p : mesh.vertices) model += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
        for (size_t i = 0; i < mesh.patchCount(); ++i) {
            model += fmt::format("usemtl m{}\nf", mesh.material[i]);
            for (const uint32_t v : mesh.patch(i)) model += fmt::format(" {}", v + 1);
            model += "\n";
        }
        for (size_t m = 0; m < mesh.materials.size(); ++m) {
            const geometry::Material& material = mesh.materials[m];
            const auto rgb = [](const char* key, glm::vec3 v) {
                return v == glm::vec3(0) ? "" : fmt::format("{} {} {} {}\n", key, v.x, v.y, v.z);
            };
            materials += fmt::format("newmtl m{}\nKd {} {} {}\n", m, material.reflectance.x,
                                     material.reflectance.y, material.reflectance.z);
            materials += rgb("Ke", material.exitance) + rgb("Tf", material.transmittance);
            if (material.isOpening()) materials += fmt::format("Ni {}\n", material.refractiveIndex);
        }
        writeText(folder / "room.obj", model);
        writeText(folder / "room.mtl", materials);
    }
    void writeSensors(const std::vector<Sensor>& sensors) const {
        std::string table = "x,y,z,nx,ny,nz\n";
        for (const Sensor& s : sensors)
            table += fmt::format("{},{},{},{},{},{}\n", s.position.x, s.position.y, s.position.z, s.normal.x,
                                 s.normal.y, s.normal.z);
        writeText(folder / "sensors.csv", table);
    }
    // Columns of the table that the command writes: lux and lux_error, or what else is named.
    struct Row {
        double lux, error, area;
    };
    std::vector<Row> illuminance(const std::string& more) const {
        const Outcome outcome = heliodon("illuminance " + in("room.obj") + " --sky " + in("sky.json") +
                                         " --quiet -o " + in("lux.csv") + " " + more);
        EXPECT_EQ(outcome.exitCode, 0) << outcome.output;
        std::istringstream file(readText(folder / "lux.csv"));
        std::string line;
        std::getline(file, line);
        std::map<std::string, size_t> column;
        const std::vector<std::string> names = split(line, ',');
        for (size_t k = 0; k < names.size(); ++k) column[names[k]] = k;
        std::vector<Row> rows;
        while (std::getline(file, line)) {
            const std::vector<std::string> cells = split(line, ',');
            const auto number = [&](const char* name) { return std::stod(cells.at(column.at(name))); };
            rows.push_back({number("lux"), number("lux_error"), column.count("area") ? number("area") : 0});
        }
        return rows;
    }
    void writeSky(int type, double groundLuminance) const {
        writeText(folder / "sky.json",
                  fmt::format(R"({{"format": "vh-sky/1", "model": "cie_general", "type": {},
                        "zenith_luminance_cdm2": 5000, "sun_direction": [0, {:.9f}, 0.5],
                        "ground": {{"luminance_cdm2": {}}}}})",
                              type, std::sqrt(0.75), groundLuminance));
    }
};

// Masks stand outside as bodies, a hair off the house.
geometry::PatchMesh modelOf(const cie171::Case& name) {
    if (name.test != "5.13" && name.test != "5.14") return cie171::roomOf(name);
    const double size = std::stod(name.opening.substr(4)), left = 2 - cie171::kFar, right = 2 + cie171::kFar;
    cie171::Hall hall = cie171::facade(true);
    if (name.test == "5.13")
        cie171::addBody(hall, {left, 3, 4.0005}, {right, 3.1, 4 + size});
    else
        cie171::addBody(hall, {left, 0, 10}, {right, size, 10.1});
    return hall.mesh;
}

// Every room under one of the skies, all skies in turn: compute/cie171 has every room under all, and here
// HELIODON_CIE171_ALL=1.
TEST_F(Cie171Command, daylight_through_openings) {
    const Csv table("cie171.csv.gz");
    const bool all = std::getenv("HELIODON_CIE171_ALL") != nullptr;
    int next = 0;
    for (const auto& [name, rows] : cie171::casesOf(table)) {
        const cie171::Places places(table, rows);
        writeModel(modelOf(name));
        writeSensors(places.sensors);
        double worst = 0, squares = 0;
        size_t count = 0, inside = 0;
        for (int k = 0; k < (all ? 16 : 1); ++k) {
            const int type = 1 + (all ? k : next++ % 16);
            const double horizontal = daylight::diffuseHorizontalIlluminance(
                daylight::cieGeneralSky(type, {0, std::sqrt(0.75), 0.5}, 5000));
            writeSky(type, cie171::hasGround(name) ? 0.3 * horizontal / std::numbers::pi : 0);
            const std::vector<Row> lux = illuminance("--sensors " + in("sensors.csv"));
            ASSERT_EQ(lux.size(), places.sensors.size());
            for (const size_t row : rows) {
                if (table.number(row, "sky") != type) continue;
                const Row& here = lux[places.sensorOfRow.at(row)];
                const double percent = 100 * here.lux / horizontal, there = table.number(row, "percent");
                // Below 0.01 % of the sky's light a difference of 0.0001 % counts as 1 %.
                const double off = std::abs(percent - there) / std::max(there, 0.01);
                worst = std::max(worst, off), squares += off * off, ++count;
                inside += std::abs(percent - there) * horizontal / 100 <= here.error + 1e-6 * horizontal;
            }
        }
        fmt::print("{:10} {:8} values {:4}  rms {:.4f} %  worst {:.3f} %  inside {:.1f} %\n", name.test,
                   name.opening, count, 100 * std::sqrt(squares / static_cast<double>(count)), 100 * worst,
                   100.0 * static_cast<double>(inside) / static_cast<double>(count));
        EXPECT_LT(worst, 0.003) << name.test << ' ' << name.opening;
        EXPECT_GE(static_cast<double>(inside), 0.99 * static_cast<double>(count));
    }
}

TEST_F(Cie171Command, configuration_factors_of_sources_and_reflectors) {
    const Csv table("cie171_kernels.csv");
    writeText(folder / "sky.json",
              R"({"format": "vh-sky/1", "model": "cie_overcast", "zenith_luminance_cdm2": 0})");
    for (const cie171::Source& source : cie171::sources(1e-4)) {
        std::vector<Sensor> sensors;
        std::vector<double> values;
        for (size_t row = 0; row < table.rows.size(); ++row)
            if (table.text(row, "test") == source.test) {
                sensors.push_back(cie171::sensorAt(table.number(row, "y"), table.number(row, "z")));
                values.push_back(table.number(row, "value"));
            }
        writeModel(source.mesh);
        writeSensors(sensors);
        const std::vector<Row> lux = illuminance("--sensors " + in("sensors.csv"));
        ASSERT_EQ(lux.size(), values.size());
        double worst = 0;
        for (size_t s = 0; s < values.size(); ++s) {
            EXPECT_NEAR(lux[s].lux, values[s], 0.001 * values[s] + 1e-5) << source.test << " sensor " << s;
            if (values[s] > 0) worst = std::max(worst, std::abs(lux[s].lux / values[s] - 1));
        }
        fmt::print("{:10} worst {:.5f} %\n", source.test, 100 * worst);
    }
}

// 5.8: a lamp of 10000 lm in the middle of a cube of 4 m. Models have no lamps without size, so the walls
// have its first reflection as exitance, square by square.
TEST_F(Cie171Command, light_reflected_within_a_cube) {
    constexpr int kSquares = 8;
    const Csv table("cie171_kernels.csv");
    writeText(folder / "sky.json",
              R"({"format": "vh-sky/1", "model": "cie_overcast", "zenith_luminance_cdm2": 0})");
    for (size_t row = 0; row < table.rows.size(); ++row) {
        if (table.text(row, "test") != "5.8") continue;
        const double rho = table.number(row, "point"), there = table.number(row, "value");
        if (rho != 0.95) continue; // compute/cie171 has all
        cie171::Hall cube;
        cube.mesh.materials.clear();
        const auto side = [&](glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v) {
            for (int i = 0; i < kSquares; ++i)
                for (int j = 0; j < kSquares; ++j) {
                    const auto at = [&](int di, int dj) {
                        return corner + (i + di) / double(kSquares) * u + (j + dj) / double(kSquares) * v;
                    };
                    // Solid angles of two triangles (Van Oosterom, Strackee 1983) are the shares of its
                    // light.
                    const auto angle = [&](glm::dvec3 p, glm::dvec3 q, glm::dvec3 r) {
                        const glm::dvec3 a = glm::normalize(p - glm::dvec3(2)),
                                         b = glm::normalize(q - glm::dvec3(2)),
                                         c = glm::normalize(r - glm::dvec3(2));
                        return 2 * std::atan2(std::abs(glm::dot(a, glm::cross(b, c))),
                                              1 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
                    };
                    const double lumens = 10000 / (4 * std::numbers::pi) *
                                          (angle(at(0, 0), at(1, 0), at(1, 1)) +
                                           angle(at(0, 0), at(1, 1), at(0, 1))),
                                 area = 16.0 / (kSquares * kSquares);
                    geometry::Material wall{"wall", glm::vec3(static_cast<float>(rho))};
                    wall.exitance = glm::vec3(static_cast<float>(rho * lumens / area));
                    const auto matter = static_cast<uint32_t>(cube.mesh.materials.size());
                    cube.mesh.materials.push_back(wall);
                    cube.add(at(0, 0), u / double(kSquares), v / double(kSquares),
                             static_cast<cie171::Matter>(matter));
                }
        };
        side({0, 0, 0}, {0, 0, 4}, {4, 0, 0}), side({0, 4, 0}, {4, 0, 0}, {0, 0, 4});
        side({0, 0, 0}, {4, 0, 0}, {0, 4, 0}), side({0, 0, 4}, {0, 4, 0}, {4, 0, 0});
        side({0, 0, 0}, {0, 4, 0}, {0, 0, 4}), side({4, 0, 0}, {0, 0, 4}, {0, 4, 0});
        writeModel(cube.mesh);
        double sum = 0;
        for (const Row& patch : illuminance("")) sum += patch.area * patch.lux / 96;
        fmt::print("5.8        rho {:.2f} off {:.4f} %\n", rho, 100 * (sum / there - 1));
        EXPECT_NEAR(sum, there, 0.001 * there) << "reflectance " << rho;
    }
}

TEST_F(Cie171Command, glass_that_cannot_be_is_said) {
    BoxRoom room;
    room.isGlass = [](glm::dvec3 p) { return p.z < 1e-9; };
    for (const auto& [transmittance, isPossible] : {std::pair(0.91f, true), std::pair(0.95f, false)}) {
        room.glass.transmittance = glm::vec3(transmittance);
        writeModel(boxRoom(room));
        const Outcome outcome =
            heliodon("illuminance " + in("room.obj") + " --sky overcast -o " + in("lux.csv"));
        EXPECT_EQ(outcome.exitCode, 0) << outcome.output;
        EXPECT_EQ(outcome.output.find("passes more than 0.918") == std::string::npos, isPossible)
            << outcome.output;
    }
}

} // namespace
} // namespace heliodon::test
