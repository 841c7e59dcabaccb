"""Sources of messages, a bus or a log, and streams of them: selected, decoded, with senders."""
