"""The channels of a bus as rows, columns and details, as `spy` and the window show them."""
