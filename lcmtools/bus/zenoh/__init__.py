"""The bus on Zenoh: its URL, its session, and what nodes and observers use of it."""
