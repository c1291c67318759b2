#include "engine/app/table_file.h"

#include <cmath>

#include "geometry/input_error.h"
#include "tests/app/program.h"

namespace heliodon::app {
namespace {

using geometry::InputError;

class TableFile : public test::InFolder {};

void writeNpy(const std::filesystem::path& file, size_t rows, size_t columns,
              const std::vector<float>& values) {
    NpyWriter::writeWhole(file, rows, columns, [&](NpyWriter& out) { out.write(values); });
}

TEST_F(TableFile, sensors_keep_other_columns_and_turn_with_the_up_axis) {
    test::writeText(in("s.csv"), "id,x,y,z,nx,ny,nz,note\r\n7, 1,2,3, 0,0,2, desk\r\n\r\n");
    const SensorTable table = readSensors(in("s.csv"), geometry::UpAxis::z);
    ASSERT_EQ(table.rows.size(), 1u);
    EXPECT_EQ(table.rows[0], "7, 1,2,3, 0,0,2, desk");
    EXPECT_EQ(table.points[0], glm::dvec3(1, 3, -2));
    EXPECT_EQ(table.normals[0], glm::dvec3(0, 1, 0));
}

TEST_F(TableFile, a_column_of_the_place_stands_once_in_a_header) {
    test::writeText(in("s.csv"), "x,y,z,nx,ny,nz,x\n1,2,3,0,0,1,4\n");
    try {
        readSensors(in("s.csv"), geometry::UpAxis::y);
        ADD_FAILURE() << "was accepted";
    } catch (const InputError& error) {
        EXPECT_TRUE(std::string(error.what()).ends_with("s.csv:1: the header has column x twice"))
            << error.what();
    }
}

TEST_F(TableFile, sensors_may_be_quoted) {
    const std::string row = "\"desk, \"\"north\"\" side\",\"1.5\", \"2\" ,\" 3\",0,\"0\",\"-1e0\",";
    test::writeText(in("s.csv"), "\"place\",\"x\",\"y\",z,nx,ny,nz,\"a, b\"\n" + row + "\n");
    const SensorTable table = readSensors(in("s.csv"), geometry::UpAxis::y);
    ASSERT_EQ(table.rows.size(), 1u);
    EXPECT_EQ(table.rows[0], row);
    EXPECT_EQ(table.points[0], glm::dvec3(1.5, 2, 3));
    EXPECT_EQ(table.normals[0], glm::dvec3(0, 0, -1));
    const std::pair<const char*, const char*> refused[]{
        {"\"1,2,3,0,0,1", "s.csv:2: a quoted cell does not end in its line, expected a closing quote"},
        {"1,2,3,0,0,\"1\"\"", "s.csv:2: a quoted cell does not end in its line, expected a closing quote"},
        {"1,2,\"3\"x,0,0,1", "s.csv:2: text follows a closing quote, expected a comma or the line's end"},
        {"\"1,2\",3,0,0,1", "s.csv:2: has 5 columns, the header has 6"},
        {"1,\"two\",3,0,0,1", "s.csv:2: column y is 'two', expected a number"}};
    for (const auto& [line, message] : refused) {
        test::writeText(in("s.csv"), std::string("x,y,z,nx,ny,nz\n") + line + "\n");
        try {
            readSensors(in("s.csv"), geometry::UpAxis::y);
            ADD_FAILURE() << line << " was accepted";
        } catch (const InputError& error) {
            EXPECT_TRUE(std::string(error.what()).ends_with(message)) << error.what();
        }
    }
}

TEST_F(TableFile, semicolons_and_tabs_become_commas_and_decimal_commas_points) {
    test::writeText(in("s.csv"), "place;x;y;z;nx;ny;nz\ndesk, north;1,5;2;;0;0;1\n");
    EXPECT_THROW(readSensors(in("s.csv"), geometry::UpAxis::y), InputError); // no z
    test::writeText(in("s.csv"), "place;x;y;z;nx;ny;nz\ndesk, north;1,5;2;-3;0;0;1\n");
    const SensorTable table = readSensors(in("s.csv"), geometry::UpAxis::y);
    EXPECT_EQ(table.header, "place,x,y,z,nx,ny,nz");
    EXPECT_EQ(table.rows, std::vector<std::string>{"\"desk, north\",1.5,2,-3,0,0,1"});
    EXPECT_EQ(table.points[0], glm::dvec3(1.5, 2, -3));
    test::writeText(in("s.csv"), "x\ty\tz\tnx\tny\tnz\tnote\r\n1\t2\t3\t0\t0\t1\t\r\n");
    EXPECT_EQ(readSensors(in("s.csv"), geometry::UpAxis::y).rows, std::vector<std::string>{"1,2,3,0,0,1,"});
    test::writeText(in("s.csv"), "x,y,z,nx,ny,nz\n+1.5,2,+3e0,0,+1,0\n");
    EXPECT_EQ(readSensors(in("s.csv"), geometry::UpAxis::y).points[0], glm::dvec3(1.5, 2, 3));
}

TEST_F(TableFile, capitals_and_blanks_are_understood_where_only_one_column_fits) {
    test::writeText(in("s.csv"), "  X Y   Z NX\tNY NZ\n1 2 3  0 0 1 \n");
    EXPECT_THROW(readSensors(in("s.csv"), geometry::UpAxis::y), InputError); // a tab, and blanks
    test::writeText(in("s.csv"), "  X Y   Z NX NY NZ\n1 2 3,5  0 0 1 \n");
    const SensorTable table = readSensors(in("s.csv"), geometry::UpAxis::y);
    EXPECT_EQ(table.header, "X,Y,Z,NX,NY,NZ");
    EXPECT_EQ(table.rows, std::vector<std::string>{"1,2,3.5,0,0,1"});
    test::writeText(in("s.csv"), "X,x,y,z,nx,ny,nz\nfirst,1,2,3,0,0,1\n");
    EXPECT_EQ(readSensors(in("s.csv"), geometry::UpAxis::y).points[0], glm::dvec3(1, 2, 3));
    test::writeText(in("s.csv"), "X,x,Y,z,nx,ny,nz\n0,1,2,3,0,0,1\n");
    EXPECT_THROW(readSensors(in("s.csv"), geometry::UpAxis::y), InputError); // which x?
}

TEST_F(TableFile, text_with_commas_is_one_field) {
    EXPECT_EQ(csvField("plain"), "plain");
    EXPECT_EQ(csvField("a, \"b\""), "\"a, \"\"b\"\"\"");
    EXPECT_EQ(csvField("two\nlines"), "\"two\nlines\"");
    test::writeText(in("s.csv"),
                    "name,x,y,z,nx,ny,nz\n" + csvField("a, \"b\"") + ",1,2,3,0,0,1\n2\" up,1,2,3,0,0,1\n");
    EXPECT_EQ(readSensors(in("s.csv"), geometry::UpAxis::y).points[0], glm::dvec3(1, 2, 3));
}

TEST_F(TableFile, bad_sensors_are_refused_by_line) {
    for (const char* text : {"", "x,y,z\n1,2,3\n", "x,y,z,nx,ny,nz\n", "x,y,z,nx,ny,nz\n1,2,3,0,0\n",
                             "x,y,z,nx,ny,nz\n1,2,nan,0,0,1\n", "x,y,z,nx,ny,nz\n1,2,3,0,0,0\n"}) {
        test::writeText(in("s.csv"), text);
        EXPECT_THROW(readSensors(in("s.csv"), geometry::UpAxis::y), InputError) << text;
    }
}

TEST_F(TableFile, sensors_without_end_are_refused) {
    std::filesystem::create_symlink("/dev/zero", in("s.csv"));
    try {
        readSensors(in("s.csv"), geometry::UpAxis::y);
        ADD_FAILURE() << "were accepted";
    } catch (const InputError& error) {
        EXPECT_EQ(std::string(error.what()),
                  in("s.csv") + ": is larger than 256 MiB, expected a table of sensors (.csv)");
    }
}

TEST_F(TableFile, matrices_come_back_as_they_were_written) {
    const std::vector<float> values{1, 2, 3, 4, 5, 6};
    writeNpy(in("m.npy"), 2, 3, values);
    EXPECT_EQ(readMatrix(in("m.npy"), 2, 3), values);
    NpyWriter::writeWhole(in("parts.npy"), 2, 3, [](NpyWriter& out) {
        out.write(std::vector<float>{1, 2});
        out.write(std::vector<float>{3, 4, 5, 6});
    });
    EXPECT_EQ(test::readText(in("parts.npy")), test::readText(in("m.npy")));
    EXPECT_EQ(std::filesystem::file_size(in("m.npy")) % 64, values.size() * sizeof(float) % 64);
    EXPECT_THROW(readMatrix(in("m.npy"), 3, 2), InputError);
    writeNpy(in("m.npy"), 2, 3, std::vector<float>{1, 2, 3, 4, std::nanf(""), 6});
    try {
        readMatrix(in("m.npy"), 2, 3);
        ADD_FAILURE() << "a value that is no number was read";
    } catch (const InputError& error) {
        EXPECT_EQ(error.what(), in("m.npy") + ":[1, 1]: is nan, expected a finite number");
    }
}

TEST_F(TableFile, tiles_lie_at_their_places_and_what_is_never_put_is_zero) {
    NpyWriter::writeWhole(in("m.npy"), 3, 4, [](NpyWriter& out) {
        out.put(1, 2, 2, 2, std::vector<float>{7, 8, 11, 12});
        out.put(0, 1, 0, 4, std::vector<float>{1, 2, 3, 4});
    });
    EXPECT_EQ(readMatrix(in("m.npy"), 3, 4), (std::vector<float>{1, 2, 3, 4, 0, 0, 7, 8, 0, 0, 11, 12}));
    MatrixFile file(in("m.npy"), 3, 4);
    EXPECT_EQ(file.read(0, 3, 2, 2), (std::vector<float>{3, 4, 7, 8, 11, 12}));
    EXPECT_EQ(file.read(1, 2, 0, 4), (std::vector<float>{0, 0, 7, 8, 0, 0, 11, 12}));
    EXPECT_EQ(file.read(0, 1, 1, 1), (std::vector<float>{2}));
    EXPECT_THROW(NpyWriter::writeWhole(in("none/m.npy"), 3, 4, [](NpyWriter&) { FAIL(); }), InputError);
}

TEST_F(TableFile, a_cut_matrix_is_refused_at_every_length) {
    const std::vector<float> values(4, 1.0f);
    writeNpy(in("m.npy"), 2, 2, values);
    const std::string whole = test::readText(in("m.npy"));
    for (size_t length = 0; length < whole.size(); ++length) {
        test::writeText(in("cut.npy"), whole.substr(0, length));
        EXPECT_THROW(readMatrix(in("cut.npy"), 2, 2), InputError) << length;
    }
}

} // namespace
} // namespace heliodon::app
