#ifdef __cplusplus
#pragma once
#endif
#include "shaders/io/io.h"
IO_BEGIN
const uint kSumsGroup = 256u; // invocations that share a row
// Rows [firstRow, firstRow + rows) by columns [firstColumn, firstColumn + columns) of a matrix.
struct MatrixSumsParams {
    uint patches; // of a row of the matrix
    uint firstRow;
    uint rows;
    uint firstColumn;
    uint columns;
    uint rowsAt;    // in `rows_`, of firstRow's first column
    uint columnsAt; // in `columns_`, of the first column of row firstColumn
    uint sumsAt;    // in `sums`, of firstRow
};
IO_END
