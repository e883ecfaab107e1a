//! Random and low-discrepancy numbers, warps to distributions with their densities, pixel filters.
