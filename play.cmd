@echo off
rem play.cmd -- ./play, for Windows:  play [arguments of playground]
rem                                   play test [arguments of pytest]
rem The stamp, a copy of pyproject.toml, is written last: a start that was stopped begins again.
setlocal
set "root=%~dp0"
set "venv=%root%.venv"
set "python=%venv%\Scripts\python.exe"
set "extra="
if "%~1"=="test" set "extra=[test]"
set "stamp=%venv%\play-stamp%extra%.toml"

fc /b "%root%pyproject.toml" "%stamp%" >nul 2>nul && goto start

if exist "%python%" goto install
set "base=py -3"
%base% -c "import sys; sys.exit(sys.version_info < (3, 11))" >nul 2>nul && goto make
set "base=python"
%base% -c "import sys; sys.exit(sys.version_info < (3, 11))" >nul 2>nul && goto make
echo play: Python 3.11 or later is needed: winget install Python.Python.3.13 1>&2
exit /b 1

:make
echo play: making .venv (the first time only) 1>&2
%base% -m venv "%venv%" || exit /b 1

:install
echo play: installing the playground (a minute or two) 1>&2
"%python%" -m pip install --quiet --disable-pip-version-check -e "%root%.%extra%" || exit /b 1
copy /y "%root%pyproject.toml" "%stamp%" >nul

:start
if defined extra goto test
"%venv%\Scripts\playground.exe" %*
exit /b %errorlevel%

:test
set "arguments="
:next
shift
if "%~1"=="" goto run
set arguments=%arguments% %1
goto next
:run
cd /d "%root%"
"%python%" -m pytest %arguments%
exit /b %errorlevel%
