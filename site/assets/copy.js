// The copy button of a console block copies the commands, without prompts and output.

function commandsOf(code) {
  const commands = [];
  let continues = false;
  for (const line of code.textContent.split('\n')) {
    const begins = line.startsWith('$ ');
    if (!begins && !continues) continue;
    commands.push(begins ? line.slice(2) : line);
    continues = line.endsWith('\\');
  }
  return commands.join('\n');
}

addEventListener('click', (event) => {
  const code = event.target.closest('.highlight button')?.closest('.highlight')
    .querySelector('code');
  // A prompt marks a console block.
  if (!code?.querySelector('.gp')) return;
  event.stopImmediatePropagation();
  event.preventDefault();
  navigator.clipboard.writeText(commandsOf(code));
}, { capture: true });
