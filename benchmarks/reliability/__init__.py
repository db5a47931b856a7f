"""Studies of reliability: wrong answers, mistakes that no test notices, and truncated files."""
