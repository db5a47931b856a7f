"""The paper that this project grew from: what it claims, and what comes out here."""
