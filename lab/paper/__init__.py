"""The paper's study: experiments, the test of their agreement, figures and the page."""
